# Run by resilin_embed.
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
string(CONFIGURE [[#include "@HEADER@"

namespace resilin {
namespace {
constexpr unsigned char bytes[] = {@bytes@};
}  // namespace
std::span<const unsigned char> @FUNCTION@() { return bytes; }
}  // namespace resilin
]] source @ONLY)
file(WRITE ${OUTPUT} "${source}")
