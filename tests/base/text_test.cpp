// Messages: one line of UTF-8 of at most so many bytes, whatever is put into them.
#include "base/text.h"

#include <random>
#include <string>

#include <gtest/gtest.h>
#include <iconv.h>

#include <darboux/error.h>

namespace darboux::text_test {
namespace {

// An independent judge of UTF-8.
bool is_utf8(std::string text) {
  const iconv_t to_utf32 = iconv_open("UTF-32", "UTF-8");
  std::string result(4 * text.size() + 8, ' ');
  char *in = text.data(), *out = result.data();
  std::size_t left = text.size(), room = result.size();
  const bool good = iconv(to_utf32, &in, &left, &out, &room) != static_cast<std::size_t>(-1) && left == 0;
  iconv_close(to_utf32);
  return good;
}

TEST(Text, OneLineEscapesWhatIsNoTextAndKeepsTheRest) {
  EXPECT_EQ(one_line("plain, é, 漢, 😀"), "plain, é, 漢, 😀");
  EXPECT_EQ(one_line(std::string("a\0b\n\t\x1b[0m\x7f", 9)), "a\\x00b\\x0A\\x09\\x1B[0m");
  EXPECT_EQ(one_line("\x7f\xff\xc3"), "\\x7F\\xFF\\xC3");
  EXPECT_EQ(one_line("\xc2\x9b"), "\\xC2\\x9B");                    // CSI
  EXPECT_EQ(one_line("\xe2\x80\xae"), "\\xE2\\x80\\xAE");           // right to left from here
  EXPECT_EQ(one_line("\xc0\xaf"), "\\xC0\\xAF");                    // longer than needed
  EXPECT_EQ(one_line("\xed\xa0\x80"), "\\xED\\xA0\\x80");           // a surrogate
  EXPECT_EQ(one_line("\xf4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80");  // beyond Unicode
}

TEST(Text, OneLineOfAnythingIsUtf8AndStaysAsItIs) {
  std::mt19937 random(1);  // NOLINT: the same texts every time
  for (int i = 0; i < 20000; ++i) {
    std::string text(random() % 12, ' ');
    // Bytes of which sequences are made are frequent.
    for (char& c : text) c = static_cast<char>(random() % 2 == 0 ? random() % 256 : 0x80 + random() % 0x78);
    const std::string line = one_line(text);
    ASSERT_TRUE(is_utf8(line)) << line;
    ASSERT_EQ(one_line(line), line);
    // What the judge takes is escaped only where it is a control character.
    if (is_utf8(text) && line != text) {
      ASSERT_NE(line.find("\\x"), std::string::npos);
    }
  }
}

TEST(Text, ShortenedKeepsBothEndsAndWholeCharacters) {
  EXPECT_EQ(shortened("abcdefghij", 10), "abcdefghij");
  EXPECT_EQ(shortened("abcdefghijk", 10), "abcd...ijk");
  for (std::size_t most = 3; most < 40; ++most) {
    const std::string text = shortened("éa漢b😀cé漢😀déa漢b😀cé漢😀d", most);
    EXPECT_LE(text.size(), most);
    EXPECT_TRUE(is_utf8(text)) << text;
  }
}

TEST(Text, ErrorsAreShortAndNameTheirSubject) {
  const std::string what =
      FileError(std::string(5000, 'n') + ".glb", std::string(5000, 'm') + ", got 3").what();
  EXPECT_LE(what.size(), 480u);
  EXPECT_NE(what.find(".glb: m"), std::string::npos) << what;
  EXPECT_TRUE(what.ends_with(", got 3")) << what;
  EXPECT_STREQ(FileError("", "expected X, got Y").what(), "\"\": expected X, got Y");
  EXPECT_STREQ(FileError("a.glb", "expected X, got Y").what(), "a.glb: expected X, got Y");
}

}  // namespace
}  // namespace darboux::text_test
