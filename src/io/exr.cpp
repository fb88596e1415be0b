// EXR images, through OpenEXR.
#include <algorithm>
#include <array>
#include <cstring>
#include <exception>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <darboux/error.h>

#include "base/text.h"
#include "image_formats.h"

namespace darboux::io {
namespace {

constexpr std::array<const char*, 4> channel_names{"R", "G", "B", "A"};

class MemoryInput final : public Imf::IStream {
 public:
  MemoryInput(const std::string& file, std::string_view bytes) : IStream(file.c_str()), bytes_(bytes) {}
  bool read(char c[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (n < 0 || at_ > bytes_.size() || count > bytes_.size() - at_)
      throw std::runtime_error("the image ends early");
    std::memcpy(c, bytes_.data() + at_, count);
    at_ += count;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

 private:
  std::string_view bytes_;
  std::uint64_t at_ = 0;
};

class MemoryOutput final : public Imf::OStream {
 public:
  explicit MemoryOutput(const std::string& file) : OStream(file.c_str()) {}
  void write(const char c[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (at_ + count > bytes.size()) bytes.resize(at_ + count);
    std::memcpy(bytes.data() + at_, c, count);
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }
  std::string bytes;

 private:
  std::uint64_t at_ = 0;
};

// Channel c of an image whose first texel is at (x, y) in the file's plane.
Imf::Slice slice_of(Image& image, std::size_t c, int x, int y) {
  const auto channels = static_cast<std::size_t>(image.channels),
             width = static_cast<std::size_t>(image.width);
  const std::size_t texel = channels * sizeof(float), row = width * texel;
  char* first = reinterpret_cast<char*>(std::get<2>(image.samples).data() + c);
  return {Imf::FLOAT,
          first - static_cast<std::ptrdiff_t>(x) * static_cast<std::ptrdiff_t>(texel) -
              static_cast<std::ptrdiff_t>(y) * static_cast<std::ptrdiff_t>(row),
          texel,
          row,
          1,
          1,
          c == 3 ? 1.0 : 0.0};
}

// Checks the size declared by the header of the first part before memory is allocated.
void check_size(const std::string& file, std::string_view bytes, const ReadImageOptions& options) {
  MemoryInput stream(file, bytes);
  char magic_and_version[8];
  stream.read(magic_and_version, 8);
  int version = 0;
  std::memcpy(&version, magic_and_version + 4, 4);
  Imf::Header header;
  header.readFrom(stream, version);
  const auto& window = header.dataWindow();
  const auto size = [](int low, int high) {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(std::int64_t{high} - low + 1, 0));
  };
  const std::uint64_t width = size(window.min.x, window.max.x), height = size(window.min.y, window.max.y);
  const std::uint64_t texel_bytes = (header.channels().findChannel("A") == nullptr ? 3 : 4) * sizeof(float);
  check_image_size(file, width, height, texel_bytes, bytes.size(), options);
  constexpr std::uint64_t any_compression = 1 << 14;
  check_compression(file, width * height * 3 * sizeof(float), bytes.size(), any_compression);
}

Image read(const std::string& file, std::string_view bytes, const ReadImageOptions& options) {
  check_size(file, bytes, options);
  MemoryInput stream(file, bytes);
  Imf::InputFile input(stream, 0);
  const auto& window = input.header().dataWindow();
  const Imf::ChannelList& list = input.header().channels();
  for (std::size_t c = 0; c < 3; ++c) {
    const Imf::Channel* channel = list.findChannel(channel_names[c]);
    if (channel == nullptr || channel->xSampling != 1 || channel->ySampling != 1)
      throw FileError(file, expected_got("an EXR image with channels R, G and B",
                                         std::string(channel_names[c]) +
                                             (channel == nullptr ? " missing" : " of another resolution")));
  }
  Image image(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1,
              list.findChannel("A") == nullptr ? 3 : 4, SampleType::f32);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < static_cast<std::size_t>(image.channels); ++c)
    buffer.insert(channel_names[c], slice_of(image, c, window.min.x, window.min.y));
  input.setFrameBuffer(buffer);
  input.readPixels(window.min.y, window.max.y);
  return image;
}

}  // namespace

bool is_exr(std::string_view bytes) {
  return bytes.starts_with("\x76\x2f\x31\x01");
}

Image image_of_exr(const std::string& file, std::string_view bytes, const ReadImageOptions& options) {
  try {
    return read(file, bytes, options);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw FileError(file, expected_got("an EXR image", e.what()));
  }
}

std::string exr_of(const std::string& path, const Image& image) {
  try {
    MemoryOutput stream(path);
    {
      Imf::Header header(image.width, image.height);
      Imf::FrameBuffer buffer;
      for (std::size_t c = 0; c < static_cast<std::size_t>(image.channels); ++c) {
        header.channels().insert(channel_names[c], Imf::Channel(Imf::FLOAT));
        buffer.insert(channel_names[c], slice_of(const_cast<Image&>(image), c, 0, 0));  // only read
      }
      Imf::OutputFile output(stream, header, 0);
      output.setFrameBuffer(buffer);
      output.writePixels(image.height);
    }
    return std::move(stream.bytes);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw FileError(path, expected_got("an EXR image to be written", e.what()));
  }
}

}  // namespace darboux::io
