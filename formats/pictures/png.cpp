// SPDX-License-Identifier: MIT
#include "formats/pictures/png.hpp"

#include <png.h>

#include <string>

#include "formats/files/output_file.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

bool is_whole(const Picture& picture) {
  return picture.width > 0 && picture.height > 0 &&
         picture.rgb.size() ==
             3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
}

}  // namespace

std::string png_bytes(const Picture& picture) {
  if (!is_whole(picture)) throw Error(Fault::internal, "a picture whose size and pixels differ");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  const int written =
      png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr);
  if (written == 0) throw Error(Fault::internal, std::string("PNG: ") + image.message);
  bytes.resize(size);
  return bytes;
}

void write_png(const Picture& picture, const std::filesystem::path& path) {
  write_whole_file(path, png_bytes(picture));
}

}  // namespace kissmap
