// SPDX-License-Identifier: MIT
#include "formats/session/local_map_ply.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

#include "formats/files/output_file.hpp"
#include "formats/session/session_folder.hpp"
#include "kissmap/error.hpp"

namespace kissmap {
namespace {

static_assert(std::endian::native == std::endian::little, "written without swapping bytes");

constexpr std::string_view header_before_count =
    "ply\n"
    "format binary_little_endian 1.0\n"
    "comment kissmap local map: frame local_map, x y z in metres\n"
    "comment nx ny nz: unit normal, sign towards the origin of the frame\n"
    "element vertex ";
constexpr std::string_view header_after_count =
    "\n"
    "property float x\n"
    "property float y\n"
    "property float z\n"
    "property float nx\n"
    "property float ny\n"
    "property float nz\n"
    "end_header\n";
constexpr std::size_t max_header_size = header_before_count.size() + 20 + header_after_count.size();

using Vertex = std::array<float, 6>;

struct Header {
  std::size_t size = 0;
  std::uint64_t vertices = 0;
};

// Only the header kissmap writes: nothing else belongs into a session.
Header parse_header(std::string_view bytes, const std::filesystem::path& path) {
  const Error damaged = input_error(
      path, std::string("the header is not that of a kissmap local map; ") + damaged_session_cure);
  if (!bytes.starts_with(header_before_count)) throw damaged;
  Header header;
  const char* begin = bytes.data() + header_before_count.size();
  const auto result = std::from_chars(begin, bytes.data() + bytes.size(), header.vertices);
  const auto count_end = static_cast<std::size_t>(result.ptr - bytes.data());
  if (result.ec != std::errc{} || !bytes.substr(count_end).starts_with(header_after_count)) {
    throw damaged;
  }
  header.size = count_end + header_after_count.size();
  return header;
}

void require_exact_size(const Header& header,
                        std::uint64_t file_size,
                        const std::filesystem::path& path) {
  const std::uint64_t body = file_size - header.size;
  if (body % sizeof(Vertex) == 0 && body / sizeof(Vertex) == header.vertices) return;
  throw input_error(path,
                    "holds " + std::to_string(body) + " bytes of points instead of " +
                        std::to_string(sizeof(Vertex)) + " for each of " +
                        std::to_string(header.vertices) + "; " + damaged_session_cure);
}

std::string read_bytes(std::ifstream& stream, std::size_t count) {
  std::string bytes(count, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  stream.clear();
  return bytes;
}

}  // namespace

void write_surfels(const SurfelCloud& surfels, const std::filesystem::path& path) {
  if (surfels.normals.size() != surfels.means.size()) {
    throw Error(Fault::internal, "surfels whose means and normals differ in number");
  }
  OutputFile file(aside(path));
  file.write(header_before_count);
  file.write(std::to_string(surfels.size()));
  file.write(header_after_count);
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const Eigen::Vector3f& p = surfels.means[i];
    const Eigen::Vector3f& n = surfels.normals[i];
    if (!p.allFinite() || !n.allFinite()) {
      throw Error(Fault::internal, "a surfel to be written is not finite");
    }
    const Vertex vertex = {p.x(), p.y(), p.z(), n.x(), n.y(), n.z()};
    file.write({reinterpret_cast<const char*>(vertex.data()), sizeof vertex});
  }
  file.close();
  rename_path(file.path(), path);
}

SurfelCloud read_surfels(const std::filesystem::path& path) {
  std::error_code code;
  const std::uint64_t file_size = std::filesystem::file_size(path, code);
  std::ifstream stream(path, std::ios::binary);
  if (code || !stream) {
    throw input_error(path, std::string("cannot be opened; ") + damaged_session_cure);
  }
  const Header header = parse_header(read_bytes(stream, max_header_size), path);
  require_exact_size(header, file_size, path);
  stream.seekg(static_cast<std::streamoff>(header.size));

  SurfelCloud surfels;
  surfels.means.reserve(header.vertices);
  surfels.normals.reserve(header.vertices);
  for (std::uint64_t i = 0; i < header.vertices; ++i) {
    Vertex v{};
    stream.read(reinterpret_cast<char*>(v.data()), sizeof v);
    surfels.means.emplace_back(v[0], v[1], v[2]);
    surfels.normals.emplace_back(v[3], v[4], v[5]);
    if (!stream || !surfels.means.back().allFinite() || !surfels.normals.back().allFinite()) {
      throw input_error(path,
                        "point " + std::to_string(i) + " is not finite or cannot be read; " +
                            damaged_session_cure);
    }
  }
  return surfels;
}

}  // namespace kissmap
