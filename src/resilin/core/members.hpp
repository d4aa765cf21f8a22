#pragma once

#include <string_view>
#include <tuple>
#include <type_traits>

namespace resilin {

/// Members of a struct: references to them, and their names with commas between.
template <class... T>
struct Members {
  std::string_view names;
  std::tuple<T&...> values;
};

/// The members of a struct with their names, comma separated in `names`.
template <class... T>
Members<T...> make_members(std::string_view names, T&... values) {
  return {names, std::tie(values...)};
}

/// T is U or const U.
template <class T, class U>
concept OneOf = std::is_same_v<std::remove_const_t<T>, U>;

/// Says, beside a struct and in its namespace, what it consists of, in the order of its declaration:
///
///   RESILIN_MEMBERS(Rotation, axis, center, degrees)
///
/// Does not compile when a member is forgotten, so that whoever adds one is led here. A macro, for C++20 has
/// no other way to the names.
#define RESILIN_MEMBERS(Struct, ...)                           \
  template <::resilin::OneOf<Struct> Whole>                    \
  auto members(Whole& whole) {                                 \
    auto& [__VA_ARGS__] = whole;                               \
    return ::resilin::make_members(#__VA_ARGS__, __VA_ARGS__); \
  }

/// Structs that list their members by a function `members`.
template <class T>
concept HasMembers = requires(T& whole) { members(whole); };

/// Calls `function(name, value)` for each member.
template <HasMembers T, class Function>
void visit_members(T& whole, const Function& function) {
  const auto all = members(whole);
  std::string_view rest = all.names;
  const auto next_name = [&rest] {
    const std::string_view name = rest.substr(0, rest.find(','));
    rest.remove_prefix(rest.size() > name.size() ? name.size() + 2 : name.size());  // ", "
    return name;
  };
  std::apply([&](auto&... values) { (function(next_name(), values), ...); }, all.values);
}

}  // namespace resilin
