#include "served_page.hpp"

#include <utility>

#include "access.hpp"
#include "recorded_fields.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/percent_decoding.hpp"
#include "resilin/results/taking_up.hpp"
#include "resilin/view/page.hpp"

namespace resilin::viewer {
namespace {

Resource page(std::string_view kind) {
  std::string nonce = make_token();
  auto html = std::make_shared<const std::string>(page_with(source_script(kind), nonce));
  return {"text/html; charset=utf-8", std::move(html), std::move(nonce)};
}

std::map<std::string, Resource> live_resources(Mailbox& mailbox, OpenFile open) {
  std::map<std::string, Resource> resources = {{"/", page("live")}};
  if (!open) return resources;
  const TakeBytes take = [&mailbox, open = std::move(open)](std::string_view target, std::string bytes) {
    const std::string name = percent_decoded(query_value(target, "name"));
    std::shared_ptr<ServedScene> scene = open(name, std::move(bytes));
    if (!mailbox.post(0, OpenScene{std::move(scene)}))
      throw InputError(name, "the simulation is too busy; try again");
    return name;
  };
  resources["/open"] = {"text/plain; charset=utf-8", take, {}};
  return resources;
}

}  // namespace

LiveServer::LiveServer(std::unique_ptr<ServedScene> scene, const ServerOptions& options, OpenFile open)
    : room_(mailbox_),
      server_(options, live_resources(mailbox_, std::move(open)), &room_),
      loop_(std::move(scene), mailbox_, [this] { server_.wake(); }) {}

std::map<std::string, Resource> recorded_resources(const std::filesystem::path& folder) {
  const RecordedFiles files(folder);
  const auto fields = std::make_shared<RecordedFields>(folder);
  const MakeBytes list = [fields](std::string_view, const std::function<bool()>&) { return fields->list(); };
  const MakeBytes values = [fields](std::string_view target, const std::function<bool()>& is_wanted) {
    return fields->values(query_value(target, "name"), is_wanted);
  };
  return {{"/", page("recorded")},
          {"/recording", {"application/octet-stream", files.recording, {}}},
          {"/report", {"application/json", files.report, {}}},
          {"/fields", {"application/json", list, {}}},
          {"/field", {"application/octet-stream", values, {}}}};
}

}  // namespace resilin::viewer
