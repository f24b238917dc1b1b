// SPDX-License-Identifier: MIT
// Figures that evo v1.36.5 (github.com/MichaelGrupp/evo, commit 26d0953) printed for the winding
// way of 900 poses, 0.4 m a pose, ten a second, with disturbance 2 against the same without. They
// must agree to the last printed digit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "kissmap/evaluation/evaluation.hpp"
#include "support/random_walk.hpp"

namespace kissmap {
namespace {

constexpr double degrees = 180.0 / std::numbers::pi;

struct Row {
  std::string choice;  // alignment, or choice of pairs
  std::string metric;  // "ate", or the delta of the relative error
  std::string quantity;
  std::vector<std::string> figures;  // rmse, mean, median, std, min, max
};

const std::vector<Row> evo_ape = {
    {"se3",
     "ate",
     "translation_m",
     {"2.080006", "1.802373", "1.801053", "1.038208", "0.020513", "3.654398"}},
    {"se3",
     "ate",
     "rotation_deg",
     {"0.872782", "0.816421", "0.864903", "0.308554", "0.072538", "1.236082"}},
    {"first",
     "ate",
     "translation_m",
     {"4.481706", "3.880749", "3.866915", "2.241758", "0.000000", "7.803451"}},
    {"first",
     "ate",
     "rotation_deg",
     {"0.985654", "0.936363", "0.989629", "0.307797", "0.000000", "1.456058"}},
    {"none",
     "ate",
     "translation_m",
     {"4.154248", "3.597395", "3.597304", "2.077625", "0.037706", "7.249819"}},
    {"none",
     "ate",
     "rotation_deg",
     {"0.872762", "0.816440", "0.866945", "0.308448", "0.071744", "1.231986"}},
};

const std::vector<Row> evo_rpe = {
    {"consecutive",
     "1f",
     "translation_m",
     {"0.115041", "0.110403", "0.113621", "0.032335", "0.017130", "0.171748"}},
    {"consecutive",
     "1f",
     "rotation_deg",
     {"0.782101", "0.736734", "0.781377", "0.262496", "0.073281", "1.103651"}},
    {"consecutive",
     "7f",
     "translation_m",
     {"0.180134", "0.166640", "0.161633", "0.068406", "0.037761", "0.334764"}},
    {"consecutive",
     "7f",
     "rotation_deg",
     {"0.423476", "0.386630", "0.417082", "0.172769", "0.033658", "0.596444"}},
    {"consecutive",
     "10m",
     "translation_m",
     {"0.247527", "0.229298", "0.226668", "0.093231", "0.079382", "0.459698"}},
    {"consecutive",
     "10m",
     "rotation_deg",
     {"1.248227", "1.073145", "0.867043", "0.637520", "0.072935", "2.240986"}},
    {"all",
     "1f",
     "translation_m",
     {"0.115041", "0.110403", "0.113621", "0.032335", "0.017130", "0.171748"}},
    {"all",
     "1f",
     "rotation_deg",
     {"0.782101", "0.736734", "0.781377", "0.262496", "0.073281", "1.103651"}},
    {"all",
     "7f",
     "translation_m",
     {"0.178801", "0.165571", "0.161301", "0.067497", "0.023787", "0.335935"}},
    {"all",
     "7f",
     "rotation_deg",
     {"0.422883", "0.385827", "0.423194", "0.173112", "0.030939", "0.596444"}},
    {"all",
     "10m",
     "translation_m",
     {"0.250219", "0.230172", "0.223734", "0.098133", "0.024697", "0.483319"}},
    {"all",
     "10m",
     "rotation_deg",
     {"1.243312", "1.091770", "0.967151", "0.594864", "0.072935", "2.257244"}},
};

std::vector<std::string> printed(const ErrorStatistics& s, double scale) {
  std::vector<std::string> figures;
  for (const double value : {s.rmse, s.mean, s.median, s.std, s.min, s.max}) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6f", scale * value);
    figures.emplace_back(text);
  }
  return figures;
}

PosePairs example() {
  PosePairs pairs;
  pairs.reference = winding_way(900, 0.4);
  pairs.estimate = winding_way(900, 0.4, 2.0);
  return pairs;
}

TEST(EvoFigures, OfTheAbsoluteError) {
  const std::map<std::string, MapAlignment> alignments = {
      {"se3", MapAlignment::se3}, {"first", MapAlignment::first}, {"none", MapAlignment::none}};
  for (const Row& row : evo_ape) {
    EvaluationOptions options;
    options.alignment = alignments.at(row.choice);
    const Evaluation e = evaluate(example(), options);
    EXPECT_EQ(row.quantity == "translation_m" ? printed(e.absolute_translation, 1.0)
                                              : printed(e.absolute_rotation, degrees),
              row.figures)
        << row.choice << " " << row.quantity;
  }
}

TEST(EvoFigures, OfTheRelativeError) {
  const std::map<std::string, Delta> deltas = {{"1f", {1.0, DeltaUnit::frames}},
                                               {"7f", {7.0, DeltaUnit::frames}},
                                               {"10m", {10.0, DeltaUnit::metres}}};
  for (const Row& row : evo_rpe) {
    EvaluationOptions options;
    options.deltas = {deltas.at(row.metric)};
    options.pairs = row.choice == "all" ? PairChoice::all : PairChoice::consecutive;
    const RelativeError error = evaluate(example(), options).relative.at(0);
    EXPECT_EQ(row.quantity == "translation_m" ? printed(error.translation, 1.0)
                                              : printed(error.rotation, degrees),
              row.figures)
        << row.choice << " " << row.metric << " " << row.quantity;
  }
}

}  // namespace
}  // namespace kissmap
