// SPDX-License-Identifier: MIT
// Angles and firing times as in the maker's user manuals (VLP-16 63-9243, HDL-32E 63-9113 and its
// application note 63-9277, VLP-32C 63-9325, VLS-128 63-9483), taken from the calibration files of
// velodyne_decoder and the parameters of the ROS driver, which agree within 0.0004 degrees.
#include "formats/sensors/velodyne_tables.hpp"

#include <algorithm>
#include <array>

namespace kissmap {
namespace {

constexpr std::array<VelodyneLaser, 16> puck{{{-15, 0},
                                              {1, 0},
                                              {-13, 0},
                                              {3, 0},
                                              {-11, 0},
                                              {5, 0},
                                              {-9, 0},
                                              {7, 0},
                                              {-7, 0},
                                              {9, 0},
                                              {-5, 0},
                                              {11, 0},
                                              {-3, 0},
                                              {13, 0},
                                              {-1, 0},
                                              {15, 0}}};

constexpr std::array<VelodyneLaser, 16> puck_hi_res{{{-10, 0},
                                                     {0.667, 0},
                                                     {-8.667, 0},
                                                     {2, 0},
                                                     {-7.333, 0},
                                                     {3.333, 0},
                                                     {-6, 0},
                                                     {4.667, 0},
                                                     {-4.667, 0},
                                                     {6, 0},
                                                     {-3.333, 0},
                                                     {7.333, 0},
                                                     {-2, 0},
                                                     {8.667, 0},
                                                     {-0.667, 0},
                                                     {10, 0}}};

constexpr std::array<VelodyneLaser, 32> hdl_32e{
    {{-30.67, 0}, {-9.33, 0},  {-29.33, 0}, {-8, 0},     {-28, 0},    {-6.67, 0},  {-26.67, 0},
     {-5.33, 0},  {-25.33, 0}, {-4, 0},     {-24, 0},    {-2.67, 0},  {-22.67, 0}, {-1.33, 0},
     {-21.33, 0}, {0, 0},      {-20, 0},    {1.33, 0},   {-18.67, 0}, {2.67, 0},   {-17.33, 0},
     {4, 0},      {-16, 0},    {5.33, 0},   {-14.67, 0}, {6.67, 0},   {-13.33, 0}, {8, 0},
     {-12, 0},    {9.33, 0},   {-10.67, 0}, {10.67, 0}}};

constexpr std::array<VelodyneLaser, 32> ultra_puck{
    {{-25, -1.4},    {-1, 4.2},     {-1.667, -1.4}, {-15.639, 1.4}, {-11.31, -1.4}, {0, 1.4},
     {-0.667, -4.2}, {-8.843, 1.4}, {-7.254, -1.4}, {0.333, 4.2},   {-0.333, -1.4}, {-6.148, 1.4},
     {-5.333, -4.2}, {1.333, 1.4},  {0.667, -4.2},  {-4, 1.4},      {-4.667, -1.4}, {1.667, 4.2},
     {1, -1.4},      {-3.667, 4.2}, {-3.333, -4.2}, {3.333, 1.4},   {2.333, -1.4},  {-2.667, 1.4},
     {-3, -1.4},     {7, 1.4},      {4.667, -1.4},  {-2.333, 4.2},  {-2, -4.2},     {15, 1.4},
     {10.333, -1.4}, {-1.333, 1.4}}};

constexpr std::size_t alpha_prime_lasers = 128;
constexpr std::array<double, alpha_prime_lasers> alpha_prime_elevations{
    -11.742, -1.99,   3.4,   -5.29,   -0.78, 4.61,  -4.08,   1.31,   -6.5,  -1.11,   4.28,  -4.41,
    0.1,     6.48,    -3.2,  2.19,    -3.86, 1.53,  -9.244,  -1.77,  2.74,  -5.95,   -0.56, 4.83,
    -2.98,   2.41,    -6.28, -0.89,   3.62,  -5.07, 0.32,    7.58,   -0.34, 5.18,    -3.64, 1.75,
    -25,     -2.43,   2.96,  -5.73,   0.54,  9.7,   -2.76,   2.63,   -7.65, -1.55,   3.84,  -4.85,
    3.18,    -5.51,   -0.12, 5.73,    -4.3,  1.09,  -16.042, -2.21,  4.06,  -4.63,   0.76,  15,
    -3.42,   1.97,    -6.85, -1.33,   -5.62, -0.23, 5.43,    -3.53,  0.98,  -19.582, -2.32, 3.07,
    -4.74,   0.65,    11.75, -2.65,   1.86,  -7.15, -1.44,   3.95,   -2.1,  3.29,    -5.4,  -0.01,
    4.5,     -4.19,   1.2,   -13.565, -1.22, 4.17,  -4.52,   0.87,   6.08,  -3.31,   2.08,  -6.65,
    1.42,    -10.346, -1.88, 3.51,    -6.06, -0.67, 4.72,    -3.97,  2.3,   -6.39,   -1,    4.39,
    -5.18,   0.21,    6.98,  -3.09,   4.98,  -3.75, 1.64,    -8.352, -2.54, 2.85,    -5.84, -0.45,
    8.43,    -2.87,   2.52,  -6.17,   -1.66, 3.73,  -4.96,   0.43};
// Neighbours of eight look to these sides.
constexpr std::array<double, 8> alpha_prime_turned{
    -6.354, -4.548, -2.732, -0.911, 0.911, 2.732, 4.548, 6.354};

constexpr std::array<VelodyneLaser, alpha_prime_lasers> alpha_prime = [] {
  std::array<VelodyneLaser, alpha_prime_lasers> lasers{};
  for (std::size_t i = 0; i < lasers.size(); ++i) {
    lasers[i] = {alpha_prime_elevations[i], alpha_prime_turned[i % alpha_prime_turned.size()]};
  }
  return lasers;
}();

constexpr double two_millimetres = 0.002;
constexpr double four_millimetres = 0.004;

constexpr std::array<VelodyneModel, 5> models{{
    {0x21, "Velodyne HDL-32E", two_millimetres, VelodynePace::thirty_two, hdl_32e},
    {0x22, "Velodyne VLP-16", two_millimetres, VelodynePace::sixteen_twice, puck},
    {0x24, "Velodyne Puck Hi-Res", two_millimetres, VelodynePace::sixteen_twice, puck_hi_res},
    {0x28, "Velodyne VLP-32C", four_millimetres, VelodynePace::thirty_two_pairs, ultra_puck},
    {0xA1, "Velodyne VLS-128", four_millimetres, VelodynePace::eights, alpha_prime},
}};

constexpr double puck_firing_us = 55.296;  // sixteen shots and the recharging after them
constexpr double puck_shot_us = 2.304;
constexpr double hdl_32e_firing_us = 46.080;
constexpr double hdl_32e_shot_us = 1.152;
constexpr double alpha_prime_stamp_us = 8.7;  // the stamp is that of the fourth group

}  // namespace

const VelodyneModel* find_velodyne_model(std::uint8_t product) {
  const auto* found = std::find_if(models.begin(), models.end(), [product](const auto& model) {
    return model.product == product;
  });
  return found == models.end() ? nullptr : found;
}

double velodyne_shot_us(VelodynePace pace, std::size_t block, std::size_t place, double group_us) {
  const auto times = [](std::size_t count, double us) { return static_cast<double>(count) * us; };
  switch (pace) {
    case VelodynePace::sixteen_twice:
      return times(2 * block + place / 16, puck_firing_us) + times(place % 16, puck_shot_us);
    case VelodynePace::thirty_two_pairs:
      return times(block, puck_firing_us) + times(place / 2, puck_shot_us);
    case VelodynePace::thirty_two:
      return times(block, hdl_32e_firing_us) + times(place, hdl_32e_shot_us);
    case VelodynePace::eights:
      break;
  }
  const std::size_t laser = 32 * (block % 4) + place;
  const std::size_t groups = laser / 8 + 2 * (laser / 64);  // two pauses halfway
  return times(block / 4, velodyne_groups_per_firing * group_us) + times(groups, group_us) -
         alpha_prime_stamp_us;
}

}  // namespace kissmap
