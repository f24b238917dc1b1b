// SPDX-License-Identifier: MIT
#include "support/map_loader_rules.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "kissmap/error.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;

struct Image {
  int width = 0;
  int height = 0;
  std::vector<double> values;  // 0 black to 255 white
};

// Next number of a PGM header; comments run from # to the end of the line.
int header_number(const std::string& bytes, std::size_t& at, const fs::path& path) {
  while (at < bytes.size() &&
         (std::isspace(static_cast<unsigned char>(bytes[at])) != 0 || bytes[at] == '#')) {
    if (bytes[at] == '#') at = std::min(bytes.find('\n', at), bytes.size() - 1);
    ++at;
  }
  int number = 0;
  const std::size_t begin = at;
  for (; at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9' && at - begin < 9; ++at) {
    number = 10 * number + (bytes[at] - '0');
  }
  if (number == 0 || at - begin == 9) throw input_error(path, "the PGM header is damaged");
  return number;
}

Image read_pgm(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file && bytes.empty()) throw input_error(path, "cannot be read");
  if (bytes.rfind("P5", 0) != 0) throw input_error(path, "is not a binary PGM (P5)");
  std::size_t at = 2;
  Image image;
  image.width = header_number(bytes, at, path);
  image.height = header_number(bytes, at, path);
  const int white = header_number(bytes, at, path);
  if (white > 255) throw input_error(path, "has more than 8 bits a pixel");
  ++at;  // one white space
  const std::size_t size =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  if (bytes.size() < at + size) throw input_error(path, "ends before its last row");
  for (std::size_t i = 0; i < size; ++i) {
    image.values.push_back(255.0 * static_cast<unsigned char>(bytes[at + i]) / white);
  }
  return image;
}

struct Facts {
  fs::path image;
  double resolution = 0.0;
  std::array<double, 3> origin{};
  bool negate = false;
  double occupied_thresh = 0.0;
  double free_thresh = 0.0;
  bool scale = false;
};

class MapYaml {
 public:
  MapYaml(const fs::path& path, MapLoader loader) : path_(path), loader_(loader) {
    try {
      document_ = YAML::LoadFile(path.string());
    } catch (const YAML::Exception& error) {
      throw input_error(path, error.what());
    }
    if (!document_.IsMap()) throw input_error(path, "holds no keys");
  }

  Facts facts() const {
    Facts facts;
    const auto image = value<std::string>("image");
    if (image.empty()) throw input_error(path_, "image is empty");
    facts.image = path_.parent_path() / image;  // an absolute path stays what it is
    facts.resolution = value<double>("resolution");
    if (!(facts.resolution > 0.0)) throw input_error(path_, "resolution is not positive");
    const auto origin = value<std::vector<double>>("origin");
    if (origin.size() != 3) throw input_error(path_, "origin needs three numbers");
    std::copy(origin.begin(), origin.end(), facts.origin.begin());
    facts.negate = negate();
    facts.occupied_thresh = value<double>("occupied_thresh");
    facts.free_thresh = value<double>("free_thresh");
    if (document_["mode"]) {
      const auto mode = value<std::string>("mode");
      if (mode != "trinary" && mode != "scale") {
        throw input_error(path_, "mode " + mode + " is neither trinary nor scale");
      }
      facts.scale = mode == "scale";
    }
    return facts;
  }

 private:
  template <typename Value>
  Value value(const char* key) const {
    const YAML::Node node = document_[key];
    if (!node) throw input_error(path_, std::string(key) + " is missing");
    try {
      return node.as<Value>();
    } catch (const YAML::Exception&) {
      throw input_error(path_, std::string(key) + " is not what it should be");
    }
  }

  bool negate() const {
    if (loader_ == MapLoader::map_server) return value<int>("negate") != 0;
    try {
      return value<int>("negate") != 0;
    } catch (const Error&) {
      return value<bool>("negate");
    }
  }

  fs::path path_;
  MapLoader loader_;
  YAML::Node document_;
};

std::int8_t cell_value(double value, const Facts& facts, MapLoader loader) {
  const double occ = (facts.negate ? value : 255.0 - value) / 255.0;
  const bool ros1 = loader == MapLoader::map_server;
  if (ros1 ? occ > facts.occupied_thresh : occ >= facts.occupied_thresh) return 100;
  if (ros1 ? occ < facts.free_thresh : occ <= facts.free_thresh) return 0;
  if (!facts.scale) return -1;
  const double ratio = (occ - facts.free_thresh) / (facts.occupied_thresh - facts.free_thresh);
  return static_cast<std::int8_t>(ros1 ? 1.0 + 98.0 * ratio : std::nearbyint(100.0 * ratio));
}

}  // namespace

LoadedMap load_map(const fs::path& yaml, MapLoader loader) {
  const Facts facts = MapYaml(yaml, loader).facts();
  const Image image = read_pgm(facts.image);
  LoadedMap map{image.width, image.height, facts.resolution, facts.origin, {}};
  for (int row = image.height - 1; row >= 0; --row) {
    for (int column = 0; column < image.width; ++column) {
      const std::size_t pixel =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
          static_cast<std::size_t>(column);
      map.data.push_back(cell_value(image.values[pixel], facts, loader));
    }
  }
  return map;
}

OccupancyPlan as_amcl_sees(const LoadedMap& map) {
  OccupancyPlan plan;
  plan.width = map.width;
  plan.height = map.height;
  plan.resolution = map.resolution;
  plan.origin = {map.origin[0], map.origin[1]};
  for (const std::int8_t value : map.data) {
    plan.cells.push_back(value == 100 ? PlanCell::occupied
                         : value == 0 ? PlanCell::free
                                      : PlanCell::unknown);
  }
  return plan;
}

}  // namespace kissmap
