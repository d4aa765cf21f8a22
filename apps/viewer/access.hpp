#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Who may talk to the page server: only a page that this server itself has handed out.
///
/// The server listens on the loopback interface alone, but every page of every site that is open in the
/// user's browser, and every other user of the machine, reaches that too. Other users do not know the token;
/// pages of other sites neither know it nor can hide their `Origin`; and a site whose name is made to point
/// to 127.0.0.1 shows in `Host`.
namespace resilin::viewer {

/// 32 hexadecimal digits from the system's source of randomness.
std::string make_token();

/// Takes the same time wherever the two differ.
bool is_same_token(std::string_view given, std::string_view token);

/// "/live?token=T" taken apart. Neither part is decoded: none of our addresses needs it.
struct Target {
  std::string_view path;
  std::string_view token;  ///< empty when there is none
};
Target parse_target(std::string_view target);

/// Value of `key=` in the query of a target; empty when there is none. Not decoded.
std::string_view query_value(std::string_view target, std::string_view key);

/// The parts of a request that decide; an absent header is empty.
struct RequestOrigin {
  std::string_view target;
  std::optional<std::string_view> host = std::nullopt;
  std::optional<std::string_view> origin = std::nullopt;
  bool needs_origin = false;  ///< for a WebSocket, and for messages of a page
};

/// Why a request gets status 403, as one line for the user; empty when it may pass.
std::string why_forbidden(const RequestOrigin& request, std::uint16_t port, std::string_view token);

}  // namespace resilin::viewer
