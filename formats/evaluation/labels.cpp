// SPDX-License-Identifier: MIT
#include "formats/files/output_file.hpp"
#include "formats/files/table.hpp"
#include "kissmap/formats/evaluation_report.hpp"

namespace kissmap {

std::string to_string(MapAlignment alignment) {
  switch (alignment) {
    case MapAlignment::se3:
      return "se3";
    case MapAlignment::yaw:
      return "yaw";
    case MapAlignment::first:
      return "first";
    case MapAlignment::none:
      break;
  }
  return "none";
}

std::string to_string(PosePairs::Side side) {
  switch (side) {
    case PosePairs::Side::reference:
      return "reference";
    case PosePairs::Side::estimate:
      return "estimate";
    case PosePairs::Side::neither:
      break;
  }
  return "neither";
}

std::string to_string(const Delta& delta) {
  std::string text;
  append_number(text, delta.value);
  switch (delta.unit) {
    case DeltaUnit::frames:
      return text + (delta.value == 1.0 ? " frame" : " frames");
    case DeltaUnit::metres:
      return text + " m";
    case DeltaUnit::seconds:
      break;
  }
  return text + " s";
}

void write_text_file(const std::filesystem::path& path, const std::string& text) {
  write_whole_file(path, text);
}

}  // namespace kissmap
