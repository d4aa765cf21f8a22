#include "page_message.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/overloaded.hpp"
#include "resilin/core/text.hpp"

namespace resilin::viewer {
namespace {

using Json = nlohmann::json;

/// A value as the user sees it in a message: short, on one line, whatever it holds.
std::string shown(const Json& value) {
  constexpr std::size_t longest = 40;
  std::string text = value.dump(-1, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace);
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  return text;
}

/// The keys of one message; each is taken once, and none may be left.
class Fields {
 public:
  Fields(const Json& json, std::string type) : json_(json), type_(std::move(type)) {}

  double number(const char* key) {
    const Json& value = take(key, "a finite number");
    if (!is_finite_number(value)) refuse(key, "a finite number", value);
    return value.get<double>();
  }

  std::uint32_t whole_number(const char* key) {
    constexpr const char* expected = "a whole number from 0";
    const Json& value = take(key, expected);
    if (!value.is_number_unsigned() ||
        value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
      refuse(key, expected, value);
    }
    return value.get<std::uint32_t>();
  }

  std::uint32_t vertex() { return whole_number("vertex"); }

  std::optional<std::size_t> optional_number(const char* key) {
    if (!json_.contains(key)) return std::nullopt;
    return whole_number(key);
  }

  std::string text(const char* key) {
    const Json& value = take(key, "a text");
    if (!value.is_string()) refuse(key, "a text", value);
    return value.get<std::string>();
  }

  /// Empty where the key is not there.
  std::string optional_text(const char* key) { return json_.contains(key) ? text(key) : std::string(); }

  bool flag(const char* key) {
    const Json& value = take(key, "true or false");
    if (!value.is_boolean()) refuse(key, "true or false", value);
    return value.get<bool>();
  }

  Vector3 vector(const char* key) {
    constexpr const char* expected = "three finite numbers";
    const Json& value = take(key, expected);
    if (!value.is_array() || value.size() != 3) refuse(key, expected, value);
    Vector3 vector;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!is_finite_number(value[i])) refuse(key, expected, value);
      vector[static_cast<Eigen::Index>(i)] = value[i].get<double>();
    }
    return vector;
  }

  /// Refuses keys that nobody has asked for.
  void finish() const {
    for (const auto& [key, value] : json_.items()) {
      if (std::ranges::find(taken_, key) != taken_.end()) continue;
      throw InputError("message \"" + type_ + "\"", "the keys " + join(taken_), shown(key));
    }
  }

 private:
  static bool is_finite_number(const Json& value) {
    return value.is_number() && std::isfinite(value.get<double>());
  }

  const Json& take(const char* key, const char* expected) {
    const auto found = json_.find(key);
    if (found == json_.end()) throw InputError("message \"" + type_ + "\": " + key, expected, "none");
    taken_.emplace_back(key);
    return *found;
  }

  [[noreturn]] void refuse(const char* key, const char* expected, const Json& value) const {
    throw InputError("message \"" + type_ + "\": " + key, expected, shown(value));
  }

  const Json& json_;
  std::string type_;
  std::vector<std::string> taken_ = {"type"};
};

PageMessage read_poke(Fields& fields) {
  Poke poke{fields.vector("center"), fields.number("radius")};
  if (!(poke.radius > 0)) {
    throw InputError("message \"poke\": radius", "a positive number", format_short(poke.radius));
  }
  return poke;
}

HoldFace read_face(Fields& fields, const std::string& type) {
  HoldFace hold{fields.vertex(), fields.vector("point"), {fields.number("angle"), fields.number("radius")}};
  if (!(hold.reach.angle >= 0 && hold.reach.angle <= 180))
    throw InputError("message \"" + type + "\": angle", "degrees from 0 to 180",
                     format_short(hold.reach.angle));
  if (!(hold.reach.radius >= 0))
    throw InputError("message \"" + type + "\": radius", "a number >= 0", format_short(hold.reach.radius));
  return hold;
}

PageMessage read_load(Fields& fields) {
  using enum FaceLoadChoice::Kind;
  LoadFace load{read_face(fields, "load"), {}};
  const std::string kind = fields.text("kind");
  if (kind != "force" && kind != "pressure")
    throw InputError("message \"load\": kind", "\"force\" or \"pressure\"", shown(kind));
  load.choice = {kind == "force" ? force : pressure, fields.number("value")};
  return load;
}

/// A word of a page, which may be of any length, in place of `refuse_word`.
[[noreturn]] void refuse_sent_word(const std::string& place, const std::string& word,
                                   const std::vector<std::string>& known) {
  throw InputError(place, "one of " + join(known), shown(word), did_you_mean(word.substr(0, 40), known));
}

ControlValue read_value(const LiveControl& control, Fields& fields) {
  return std::visit(Overloaded{
                        [&](const Switch&) -> ControlValue { return fields.flag("value"); },
                        [&](const Choice&) -> ControlValue { return fields.text("value"); },
                        [&](const Arrow&) -> ControlValue { return fields.vector("value"); },
                        [&](const auto&) -> ControlValue { return fields.number("value"); },
                    },
                    control.form);
}

PageMessage read_set(Fields& fields) {
  const std::string key = fields.text("key");
  if (key.starts_with("drive.")) return SetControl{.value = fields.number("value"), .drive = key};
  const LiveControl* control = find_live_control(key);
  if (control != nullptr) {
    SetControl set{control, read_value(*control, fields)};
    if (control->is_of_body) set.body = fields.optional_number("body");
    return set;
  }
  std::vector<std::string> known;
  for (const LiveControl& entry : live_control_table()) known.emplace_back(entry.key);
  refuse_sent_word("message \"set\": key", key, known);
}

using ReadMessage = PageMessage (*)(Fields&);

template <class Message>
PageMessage plain(Fields&) {
  return Message{};
}

const std::map<std::string, ReadMessage, std::less<>>& message_types() {
  static const std::map<std::string, ReadMessage, std::less<>> table = {
      {"grab", [](Fields& f) -> PageMessage { return Grab{f.vertex(), f.vector("point")}; }},
      {"release", plain<Release>},
      {"pin", [](Fields& f) -> PageMessage { return Pin{f.vertex()}; }},
      {"unpin", [](Fields& f) -> PageMessage { return Unpin{f.vertex()}; }},
      {"unpin_all", plain<UnpinAll>},
      {"hold", [](Fields& f) -> PageMessage { return read_face(f, "hold"); }},
      {"free_faces", plain<FreeFaces>},
      {"load", read_load},
      {"remove_loads", plain<RemoveLoads>},
      {"settle", plain<Settle>},
      {"poke", read_poke},
      {"poke_end", plain<PokeEnd>},
      {"set", read_set},
      {"field",
       [](Fields& f) -> PageMessage { return ChooseField{f.text("name"), f.optional_text("arrows")}; }},
      {"pause", plain<Pause>},
      {"play", plain<Play>},
      {"step", plain<SingleStep>},
      {"reset", plain<Reset>},
      {"reload", plain<Reload>},
      {"save", plain<SaveScene>},
  };
  return table;
}

std::vector<std::string> names_of_types() {
  std::vector<std::string> names;
  for (const auto& [name, read] : message_types()) names.push_back(name);
  return names;
}

template <class Number>
Number read_little_endian(std::string_view bytes, std::size_t offset) {
  static_assert(std::endian::native == std::endian::little, "other machines need their bytes swapped here");
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

PageMessage read_drag(std::string_view bytes) {
  Drag drag{read_little_endian<std::uint32_t>(bytes, 4), {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto coordinate = read_little_endian<float>(bytes, 8 + 4 * i);
    if (!std::isfinite(coordinate)) {
      throw InputError("drag: target", "three finite numbers", std::to_string(coordinate));
    }
    drag.target[static_cast<Eigen::Index>(i)] = static_cast<double>(coordinate);
  }
  return drag;
}

}  // namespace

PageMessage read_text_message(std::string_view text) {
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) {
    throw InputError("message", "one object of JSON with a \"type\"",
                     json.is_discarded() ? "no JSON" : shown(json));
  }
  const auto type = json.find("type");
  if (type == json.end() || !type->is_string()) {
    throw InputError("message: type", "one of " + join(names_of_types()),
                     type == json.end() ? "none" : shown(*type));
  }
  const auto& name = type->get_ref<const std::string&>();
  const auto entry = message_types().find(name);
  if (entry == message_types().end()) refuse_sent_word("message: type", name, names_of_types());
  Fields fields(json, name);
  PageMessage message = entry->second(fields);
  fields.finish();
  return message;
}

PageMessage read_binary_message(std::string_view bytes) {
  constexpr unsigned char acknowledge = 1, drag = 2;
  const auto kind = bytes.empty() ? 0 : static_cast<unsigned char>(bytes[0]);
  const bool is_padded = bytes.size() >= 4 && bytes[1] == 0 && bytes[2] == 0 && bytes[3] == 0;
  if (is_padded && kind == acknowledge && bytes.size() == 8) {
    return Acknowledge{read_little_endian<std::uint32_t>(bytes, 4)};
  }
  if (is_padded && kind == drag && bytes.size() == 20) return read_drag(bytes);
  throw InputError("binary message", "an acknowledgement of 8 bytes or a drag of 20",
                   std::to_string(bytes.size()) + " bytes of kind " + std::to_string(kind));
}

}  // namespace resilin::viewer
