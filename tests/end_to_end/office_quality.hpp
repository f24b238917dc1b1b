// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "end_to_end/grid_quality.hpp"
#include "kissmap/grid/band_mapper.hpp"
#include "simulator/office.hpp"
#include "support/occupancy_plan.hpp"

namespace kissmap {

/// Judges maps of bands of a simulated office; `reach` [cells] as in GridJudge.
std::vector<GridQuality> judge_office(const simulator::Simulator& simulator,
                                      const std::vector<GridBand>& bands,
                                      const std::vector<GridMap>& maps,
                                      int reach);

/// What a map for robots has to reach.
void expect_office_plan(const GridQuality& quality);

/// A robot 0.4 m wide gets through every open door and through none that is closed.
void expect_doors_as_they_are(const simulator::Office& office, const GridMap& map);

OccupancyPlan plan_of(const GridMap& map);

}  // namespace kissmap
