#include "access.hpp"

#include <array>
#include <random>

namespace resilin::viewer {
namespace {

bool is_own_host(std::string_view host, std::uint16_t port) {
  const auto colon = host.rfind(':');
  if (colon == std::string_view::npos || host.substr(colon + 1) != std::to_string(port)) return false;
  const std::string_view name = host.substr(0, colon);
  return name == "127.0.0.1" || name == "localhost";
}

bool is_own_origin(std::string_view origin, std::uint16_t port) {
  constexpr std::string_view scheme = "http://";
  return origin.starts_with(scheme) && is_own_host(origin.substr(scheme.size()), port);
}

}  // namespace

std::string make_token() {
  constexpr std::string_view digits = "0123456789abcdef";
  std::random_device device;
  std::uniform_int_distribution<std::size_t> digit(0, digits.size() - 1);
  std::string token(32, '0');
  for (char& letter : token) letter = digits[digit(device)];
  return token;
}

bool is_same_token(std::string_view given, std::string_view token) {
  if (given.size() != token.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < token.size(); ++i) {
    difference |=
        static_cast<unsigned char>(given[i]) ^ static_cast<unsigned>(static_cast<unsigned char>(token[i]));
  }
  return difference == 0;
}

Target parse_target(std::string_view target) {
  return {target.substr(0, target.find('?')), query_value(target, "token")};
}

std::string_view query_value(std::string_view target, std::string_view key) {
  const std::size_t question = target.find('?');
  std::string_view query =
      question == std::string_view::npos ? std::string_view{} : target.substr(question + 1);
  while (!query.empty()) {
    const std::size_t end = query.find('&');
    const std::string_view pair = query.substr(0, end);
    if (pair.starts_with(key) && pair.substr(key.size()).starts_with('=')) return pair.substr(key.size() + 1);
    query = end == std::string_view::npos ? std::string_view{} : query.substr(end + 1);
  }
  return {};
}

std::string why_forbidden(const RequestOrigin& request, std::uint16_t port, std::string_view token) {
  if (!request.host || !is_own_host(*request.host, port)) {
    return "This server answers only to 127.0.0.1:" + std::to_string(port) +
           "; open the address that `resilin view` printed.";
  }
  // A browser sends no Origin when the user opens an address, and always sends one with a WebSocket and a
  // POST.
  if (request.origin ? !is_own_origin(*request.origin, port) : request.needs_origin) {
    return "Pages of other sites may not talk to this server; open the address that `resilin view` printed.";
  }
  if (!is_same_token(parse_target(request.target).token, token)) {
    return "The token in the address is wrong or missing; each start of `resilin view` prints a new address.";
  }
  return {};
}

}  // namespace resilin::viewer
