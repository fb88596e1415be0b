// Images as numbers: what is written reads back, colour tags are refused, broken files end in one line.
#include <cmath>
#include <limits>

#include <darboux/error.h>
#include <darboux/image_files.h>
#include <darboux/io.h>

#include "io_files.h"
#include "map_meshes.h"
#include "png_bytes.h"
#include "refusal_of.h"

namespace darboux::test::image_files_test {
namespace {

// A PNG with one chunk more, before its data.
std::string with_chunk(const std::string& png, const std::string& type, const std::string& content) {
  std::string body = type + content;
  const auto be32 = [](std::uint32_t x) {
    return std::string{static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8),
                       static_cast<char>(x)};
  };
  std::uint32_t crc = 0xffffffff;
  for (const char c : body) {
    crc ^= static_cast<std::uint8_t>(c);
    for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1)));
  }
  std::string result = png;
  return result.insert(33, be32(static_cast<std::uint32_t>(content.size())) + body + be32(~crc));
}

Image image_of(SampleType type, int channels) {
  Image three = random_directions(13, 7, type, 3);
  if (channels == 3) return three;
  Image four(13, 7, 4, type);
  std::visit(
      [&](auto& to) {
        const auto& from = std::get<std::remove_reference_t<decltype(to)>>(three.samples);
        for (std::size_t i = 0; i < four.texels(); ++i) {
          for (std::size_t c = 0; c < 3; ++c) to[4 * i + c] = from[3 * i + c];
          to[4 * i + 3] = static_cast<typename std::remove_reference_t<decltype(to)>::value_type>(i);
        }
      },
      four.samples);
  return four;
}

TEST(ImageFiles, WhatIsWrittenReadsBack) {
  const TempFolder folder;
  for (const auto& [name, type] : {std::pair{"a.png", SampleType::u8},
                                   {"b.PNG", SampleType::u16},
                                   {"c.tga", SampleType::u8},
                                   {"d.exr", SampleType::f32}})
    for (const int channels : {3, 4}) {
      Image image = image_of(type, channels);
      if (type == SampleType::f32) std::get<2>(image.samples)[5] = std::numeric_limits<float>::infinity();
      write_image(folder / name, image);
      const Image back = read_image(folder / name);
      EXPECT_EQ(back.width, 13);
      EXPECT_EQ(back.height, 7);
      EXPECT_EQ(back.channels, channels) << name;
      EXPECT_TRUE(back.samples == image.samples) << name << ' ' << channels;
    }
  EXPECT_EQ(folder.files(), 4u);
  for (const char* tag : {"sRGB", "gAMA", "cHRM", "iCCP"})
    EXPECT_EQ(read_bytes(folder / "a.png").find(tag), std::string::npos) << tag;
}

TEST(ImageFiles, NanIsReadAsItIs) {
  const TempFolder folder;
  Image image = image_of(SampleType::f32, 3);
  std::get<2>(image.samples)[7] = std::numeric_limits<float>::quiet_NaN();
  write_image(folder / "nan.exr", image);
  EXPECT_TRUE(std::isnan(std::get<2>(read_image(folder / "nan.exr").samples)[7]));
}

TEST(ImageFiles, OthersPngsAreRead) {
  const TempFolder folder;
  const std::vector<std::uint16_t> texels{1, 2, 3, 250, 251, 252};
  write_bytes(folder / "interlaced.png", png_bytes(2, 1, texels, {.interlaced = true}));
  EXPECT_EQ(std::get<0>(read_image(folder / "interlaced.png").samples),
            (std::vector<std::uint8_t>{1, 2, 3, 250, 251, 252}));
}

TEST(ImageFiles, ColourTagsAreRefusedOrDropped) {
  const TempFolder folder;
  const std::string png = png_bytes(2, 1, {1, 2, 3, 250, 251, 252});
  const auto be32 = [](std::uint32_t x) {
    return std::string{static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8),
                       static_cast<char>(x)};
  };
  const std::string path = folder / "tagged.png";
  for (const auto& [type, content, name] :
       {std::tuple<std::string, std::string, std::string>{"sRGB", std::string(1, '\0'), "sRGB"},
        {"gAMA", be32(45455), "gAMA 0.45455"}}) {
    write_bytes(path, with_chunk(png, type, content));
    const std::string refusal = refusal_of<FileError>([&] { read_image(path); });
    EXPECT_NE(refusal.find(name), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("--drop-colour-tags"), std::string::npos) << refusal;
    EXPECT_EQ(image_colour_tag(path), name);
    EXPECT_EQ(std::get<0>(read_image(path, {.drop_colour_tags = true}).samples),
              (std::vector<std::uint8_t>{1, 2, 3, 250, 251, 252}));
  }
  write_bytes(path, with_chunk(png, "gAMA", be32(100000)));
  EXPECT_EQ(read_image(path).width, 2) << "a gamma of 1 is linear";
  EXPECT_EQ(image_colour_tag(path), "");

  // TGA 2.0: an extension area with a gamma of 22/10, and the footer.
  Image image = image_of(SampleType::u8, 3);
  write_image(folder / "a.tga", image);
  std::string tga = read_bytes(folder / "a.tga");
  const auto area = static_cast<std::uint32_t>(tga.size());
  tga += std::string(495, '\0');
  tga[area + 478] = 22;
  tga[area + 480] = 10;
  tga += std::string{static_cast<char>(area), static_cast<char>(area >> 8), 0, 0, 0, 0, 0, 0};
  tga += std::string("TRUEVISION-XFILE.\0", 18);
  write_bytes(folder / "b.tga", tga);
  const std::string refusal = refusal_of<FileError>([&] { read_image(folder / "b.tga"); });
  EXPECT_NE(refusal.find("gamma 2.2"), std::string::npos) << refusal;
  EXPECT_EQ(image_colour_tag(folder / "b.tga"), "gamma 2.2");
  EXPECT_TRUE(read_image(folder / "b.tga", {.drop_colour_tags = true}).samples == image.samples);
}

TEST(ImageFiles, RefusesPalettesGreyAndOthers) {
  const TempFolder folder;
  const auto refusal = [&](const std::string& name, const std::string& bytes) {
    write_bytes(folder / name, bytes);
    return refusal_of<FileError>([&] { read_image(folder / name); });
  };
  const auto expect = [](const std::string& text, const char* part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect(
      refusal("p.png", png_bytes(2, 1, {0, 1}, {.colour_type = PNG_COLOR_TYPE_PALETTE}, {1, 2, 3, 4, 5, 6})),
      "palette");
  expect(refusal("g.png", png_bytes(2, 1, {0, 1}, {.colour_type = PNG_COLOR_TYPE_GRAY})), "grey");
  expect(refusal("n.png", "nonsense"), "PNG, TGA or EXR");
  expect(refusal("e.png", ""), "PNG, TGA or EXR");
  const auto tga = [](int type, int bits, int descriptor = 0, int map = 0) {
    std::string bytes(18 + 4 * 4, '\0');
    bytes[1] = static_cast<char>(map);
    bytes[2] = static_cast<char>(type);
    bytes[12] = bytes[14] = 2;
    bytes[16] = static_cast<char>(bits);
    bytes[17] = static_cast<char>(descriptor);
    return bytes;
  };
  EXPECT_EQ(refusal("good.tga", tga(2, 32)), "accepted");
  expect(refusal("a.tga", tga(1, 8, 0, 1)), "palette");
  expect(refusal("b.tga", tga(3, 8)), "grey");
  expect(refusal("c.tga", tga(2, 16)), "16 bits");
  expect(refusal("d.tga", tga(2, 24, 16)), "right to left");
  expect(refusal("e.tga", tga(7, 24)), "type 7");
  expect(refusal_of<FileError>([&] { read_image(folder / "missing.png"); }), "missing.png");
  EXPECT_REFUSED(write_image(folder / "x.jpg", image_of(SampleType::u8, 3)), ".png, .tga or .exr");
  EXPECT_REFUSED(write_image(folder / "x.tga", image_of(SampleType::u16, 3)), "expected 8 bits, got 16 bits");
  EXPECT_REFUSED(write_image(folder / "x.png", image_of(SampleType::f32, 3)), "8 or 16 bits");
  for (const char* name : {"x.png", "x.tga", "x.exr"}) {
    const SampleType type = image_types(folder / name).back();
    Image wrong = image_of(type, 3);
    wrong.width = 8000;
    EXPECT_REFUSED(write_image(folder / name, wrong), "width * height * channels");
    EXPECT_REFUSED(write_image(folder / name, Image(4, 4, 2, type)), "3 or 4 channels");
    EXPECT_REFUSED(write_image(folder / name, Image(0, 4, 3, type)), "width * height * channels");
  }
}

// Whatever is missing at the end, the file is refused in one line; of a PNG, TGA and EXR every length.
TEST(ImageFiles, RefusesTruncatedFilesOfEveryLength) {
  const TempFolder folder;
  for (const auto& [name, type] :
       {std::pair{"a.png", SampleType::u16}, {"b.tga", SampleType::u8}, {"c.exr", SampleType::f32}}) {
    write_image(folder / name, image_of(type, 4));
    const std::string whole = read_bytes(folder / name);
    ASSERT_NO_THROW(read_image(folder / name));
    std::size_t accepted = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      write_bytes(folder / name, whole.substr(0, size));
      const std::string message = refusal_of<FileError>([&] { read_image(folder / name); });
      accepted += message == "accepted";
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    // stb ends a TGA with a footer that holds no texels.
    EXPECT_LE(accepted, std::string(name) == "b.tga" ? 26u : 0u) << name;
  }
}

// An image counts against the budget of its file, as meshes do.
TEST(ImageFiles, TakesNoMoreThanItsBudget) {
  const TempFolder folder;
  for (const char* name : {"a.png", "a.tga", "a.exr"}) {
    const SampleType type = std::string(name) == "a.exr" ? SampleType::f32 : SampleType::u8;
    write_image(folder / name, image_of(type, 3));
    const std::size_t bytes = read_image(folder / name).bytes() * (std::string(name) == "a.tga" ? 2 : 1);
    EXPECT_NO_THROW(read_image(folder / name, {.max_memory = bytes}));
    const std::string refusal =
        refusal_of<FileError>([&] { read_image(folder / name, {.max_memory = bytes - 1}); });
    EXPECT_NE(refusal.find("--max-memory"), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("for an image of "), std::string::npos) << refusal;
  }
}

// What claims to be of 65 536 x 65 536 texels is refused before memory is taken.
TEST(ImageFiles, RefusesHugeClaims) {
  const TempFolder folder;
  std::string png = png_bytes(2, 1, {1, 2, 3, 250, 251, 252});
  // The header's checksum is that of these bytes: libpng checks it.
  std::string header = png.substr(16, 13);
  header.replace(0, 8, std::string("\0\1\0\0\0\1\0\0", 8));
  const std::string huge =
      with_chunk(png.substr(0, 8) + std::string(25, ' '), "IHDR", header).erase(8, 25) + png.substr(33);
  write_bytes(folder / "a.png", huge);
  EXPECT_NE(refusal_of<FileError>([&] { read_image(folder / "a.png"); }).find("65536 x 65536"),
            std::string::npos)
      << refusal_of<FileError>([&] { read_image(folder / "a.png"); });
  header.replace(0, 8, std::string("\0\0\x20\0\0\0\x20\0", 8));
  write_bytes(
      folder / "b.png",
      with_chunk(png.substr(0, 8) + std::string(25, ' '), "IHDR", header).erase(8, 25) + png.substr(33));
  EXPECT_NE(refusal_of<FileError>([&] { read_image(folder / "b.png"); }).find("1032 times its bytes"),
            std::string::npos)
      << "67 108 864 texels in 70 bytes: " << refusal_of<FileError>([&] { read_image(folder / "b.png"); });
  std::string tga(18, '\0');
  tga[2] = 10;
  tga[12] = tga[13] = tga[14] = tga[15] = static_cast<char>(255);
  tga[16] = 24;
  write_bytes(folder / "a.tga", tga);
  EXPECT_NE(refusal_of<FileError>([&] { read_image(folder / "a.tga"); }).find("65535 x 65535"),
            std::string::npos);
  write_image(folder / "a.exr", image_of(SampleType::f32, 3));
  std::string exr = read_bytes(folder / "a.exr");
  const std::size_t window = exr.find("dataWindow") + 11 + 6 + 4;
  exr.replace(window + 8, 8, std::string("\xff\xff\0\0\xff\xff\0\0", 8));
  write_bytes(folder / "a.exr", exr);
  EXPECT_NE(refusal_of<FileError>([&] { read_image(folder / "a.exr"); }).find("65536 x 65536"),
            std::string::npos)
      << refusal_of<FileError>([&] { read_image(folder / "a.exr"); });
}

TEST(ImageFiles, AnExrNeedsRedGreenAndBlue) {
  const TempFolder folder;
  write_image(folder / "a.exr", image_of(SampleType::f32, 3));
  std::string exr = read_bytes(folder / "a.exr");
  const std::size_t green = exr.find(std::string("G\0\2\0\0\0", 6), exr.find("chlist"));
  ASSERT_NE(green, std::string::npos);
  exr[green] = 'H';
  write_bytes(folder / "a.exr", exr);
  EXPECT_EQ(refusal_of<FileError>([&] { read_image(folder / "a.exr"); }),
            (folder / "a.exr") + ": expected an EXR image with channels R, G and B, got G missing");
}

}  // namespace
}  // namespace darboux::test::image_files_test
