# Writes OUTPUT, a C++ source that defines `extern const std::string_view NAME` with the bytes of INPUT, and NAME_sha256 with
# their digest in hexadecimal.
file(SHA256 ${INPUT} digest)
file(READ ${INPUT} bytes HEX)
string(LENGTH "${bytes}" digits)
math(EXPR size "${digits} / 2")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE ${OUTPUT} "#include <string_view>
namespace {
constexpr unsigned char bytes[] = {${bytes}};
}
namespace darboux {
extern const std::string_view ${NAME};
const std::string_view ${NAME}{reinterpret_cast<const char*>(bytes), ${size}};
extern const std::string_view ${NAME}_sha256;
const std::string_view ${NAME}_sha256{\"${digest}\"};
}
")
