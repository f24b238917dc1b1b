// SPDX-License-Identifier: MIT
#include <fstream>

#include "bench/byte_text.hpp"
#include "bench/hall_scans.hpp"
#include "bench/recorded_logs.hpp"

namespace kissmap {
namespace {

constexpr std::uint64_t ns_a_second = 1'000'000'000;
constexpr std::size_t different_clouds = 8;

struct Field {
  const char* name;
  std::uint32_t offset;
  std::uint8_t type;  // of sensor_msgs/PointField: 4 uint16, 6 uint32, 7 float32
};
const std::vector<Field>& fields_of(PointLayout layout) {
  static const std::vector<Field> ouster{{"x", 0, 7},
                                         {"y", 4, 7},
                                         {"z", 8, 7},
                                         {"intensity", 16, 7},
                                         {"t", 20, 6},
                                         {"reflectivity", 24, 4},
                                         {"ring", 26, 4},
                                         {"ambient", 28, 4},
                                         {"range", 32, 6}};
  static const std::vector<Field> velodyne{{"x", 0, 7},
                                           {"y", 4, 7},
                                           {"z", 8, 7},
                                           {"intensity", 12, 7},
                                           {"ring", 16, 4},
                                           {"time", 18, 7}};
  return layout == PointLayout::ouster_48 ? ouster : velodyne;
}

std::string point(PointLayout layout, const Eigen::Vector3f& p, std::size_t column, int ring) {
  const auto intensity = static_cast<float>(static_cast<int>(40.0F * p.norm()) % 256);
  const double seconds = 0.1 * static_cast<double>(column) / cloud_columns;
  ByteText bytes;
  bytes.add<float>(p.x()).add<float>(p.y()).add<float>(p.z());
  if (layout == PointLayout::velodyne_22) {
    bytes.add<float>(intensity).add<std::uint16_t>(static_cast<std::uint16_t>(ring));
    return bytes.add<float>(static_cast<float>(seconds)).text();
  }
  bytes.add<float>(1).add<float>(intensity);
  bytes.add<std::uint32_t>(static_cast<std::uint32_t>(1e9 * seconds));
  bytes.add<std::uint16_t>(static_cast<std::uint16_t>(intensity));
  bytes.add<std::uint16_t>(static_cast<std::uint16_t>(ring));
  bytes.add<std::uint16_t>(static_cast<std::uint16_t>(column % 100)).add<std::uint16_t>(0);
  return bytes.add<std::uint32_t>(static_cast<std::uint32_t>(1e3F * p.norm())).pad_to(48).text();
}

/// A ROS message as ROS 1 or as ROS 2 serialises it.
class MessageText {
 public:
  explicit MessageText(bool cdr) : cdr_(cdr) {}

  template <class T>
  MessageText& add(std::type_identity_t<T> value) {
    if (cdr_) bytes_.pad_to((bytes_.size() + sizeof(T) - 1) / sizeof(T) * sizeof(T));
    bytes_.add<T>(value);
    return *this;
  }
  MessageText& add_text(std::string_view text) {
    add<std::uint32_t>(static_cast<std::uint32_t>(text.size() + (cdr_ ? 1 : 0)));
    bytes_.add_text(text);
    if (cdr_) bytes_.add<char>('\0');
    return *this;
  }
  MessageText& add_bytes(std::string_view bytes) {
    add<std::uint32_t>(static_cast<std::uint32_t>(bytes.size()));
    bytes_.add_text(bytes);
    return *this;
  }
  std::string text() const {
    return (cdr_ ? std::string("\0\1\0\0", 4) : std::string()) + bytes_.text();
  }

 private:
  ByteText bytes_;
  bool cdr_;
};

}  // namespace

RecordedClouds record_clouds(PointLayout layout, std::size_t count) {
  RecordedClouds clouds{layout, {}, count};
  const Hall hall;
  for (std::size_t i = 0; i < different_clouds; ++i) {
    const SimulatedScan scan = simulate(hall, static_cast<int>(i), different_clouds);
    std::string data(scan.ends.size() * clouds.point_step(), '\0');
    for (std::size_t k = 0; k < scan.ends.size(); ++k) {  // column by column
      const std::size_t column = k / cloud_rows;
      const std::size_t row = k % cloud_rows;
      const Eigen::Vector3f p = scan.is_hit[k] != 0 ? Eigen::Vector3f(scan.ends[k] - scan.sensor)
                                                    : Eigen::Vector3f::Zero();
      const std::string bytes = point(layout, p, column, static_cast<int>(row));
      data.replace((row * cloud_columns + column) * bytes.size(), bytes.size(), bytes);
    }
    clouds.different.push_back(std::move(data));
  }
  return clouds;
}

std::uint64_t recorded_ns(std::size_t i) {
  return std::uint64_t{1'700'000'000} * ns_a_second + i * 100'000'000;
}

std::string cloud_message(const RecordedClouds& clouds, std::size_t i, bool cdr) {
  MessageText message(cdr);
  if (!cdr) message.add<std::uint32_t>(static_cast<std::uint32_t>(i));
  message.add<std::uint32_t>(static_cast<std::uint32_t>(recorded_ns(i) / ns_a_second));
  message.add<std::uint32_t>(static_cast<std::uint32_t>(recorded_ns(i) % ns_a_second));
  message.add_text("lidar").add<std::uint32_t>(cloud_rows).add<std::uint32_t>(cloud_columns);
  const auto& fields = fields_of(clouds.layout);
  message.add<std::uint32_t>(static_cast<std::uint32_t>(fields.size()));
  for (const Field& field : fields) {
    message.add_text(field.name).add<std::uint32_t>(field.offset).add<std::uint8_t>(field.type);
    message.add<std::uint32_t>(1);
  }
  const auto step = static_cast<std::uint32_t>(clouds.point_step());
  message.add<std::uint8_t>(0).add<std::uint32_t>(step);
  message.add<std::uint32_t>(step * static_cast<std::uint32_t>(cloud_columns));
  return message.add_bytes(clouds.data(i)).add<std::uint8_t>(1).text();
}

void write_pcd_folder(const std::filesystem::path& folder, const RecordedClouds& clouds) {
  std::filesystem::create_directories(folder);
  const std::string points = std::to_string(cloud_rows * cloud_columns);
  for (std::size_t i = 0; i < clouds.count; ++i) {
    const std::string name = std::to_string(recorded_ns(i)) + ".pcd";
    std::ofstream(folder / name, std::ios::binary)
        << "VERSION 0.7\nFIELDS x y z intensity ring time\nSIZE 4 4 4 4 2 4\nTYPE F F F F U F\n"
        << "COUNT 1 1 1 1 1 1\nWIDTH " << points << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS "
        << points << "\nDATA binary\n"
        << clouds.data(i);
  }
}

}  // namespace kissmap
