// SPDX-License-Identifier: MIT
#include "end_to_end/office_quality.hpp"

#include <gtest/gtest.h>

#include <deque>

namespace kissmap {
namespace {

using simulator::ObjectClass;

constexpr std::size_t every = 4;            // scans
constexpr std::size_t every_crossing = 24;  // scans whose crossings are found exactly

CellState state_at(const GridMap& map, const Eigen::Vector2d& place) {
  const Eigen::Vector2i cell = map.cell_of(place);
  return map.holds(cell.x(), cell.y()) ? map.at(cell.x(), cell.y()).state : CellState::unknown;
}

/// How many of the cells on a way 0.8 m through the door, `aside` [m] of its middle, are not free.
int cells_in_the_way(const GridMap& map, const simulator::PlanDoor& door, double aside) {
  const Eigen::Vector2d side(-door.into_room.y(), door.into_room.x());
  int cells = 0;
  for (double way = -0.4; way <= 0.4; way += map.resolution) {
    const Eigen::Vector2d place = door.middle + way * door.into_room + aside * side;
    cells += state_at(map, place) == CellState::free ? 0 : 1;
  }
  return cells;
}

}  // namespace

std::vector<GridQuality> judge_office(const simulator::Simulator& simulator,
                                      const std::vector<GridBand>& bands,
                                      const std::vector<GridMap>& maps,
                                      int reach) {
  std::deque<GridJudge> judges;
  for (std::size_t k = 0; k < bands.size(); ++k) {
    judges.emplace_back(
        simulator, simulator::FloorBand{bands[k].z_min, bands[k].z_max, 0}, maps[k]);
  }
  for (std::size_t i = 1; i < simulator.scan_count(); i += every) {
    for (GridJudge& judge : judges) judge.observe(i, i % every_crossing == 1);
  }
  std::vector<GridQuality> found;
  for (const GridJudge& judge : judges) found.push_back(judge.judge(reach));
  return found;
}

void expect_office_plan(const GridQuality& quality) {
  EXPECT_GE(quality.precision, 0.95);
  EXPECT_GE(quality.recall, 0.95);
  EXPECT_GE(quality.free_recall, 0.98);
  for (const ObjectClass c : {ObjectClass::wall,
                              ObjectClass::door,
                              ObjectClass::desk_leg,
                              ObjectClass::chair_leg,
                              ObjectClass::cabinet}) {
    EXPECT_GE(quality.recall_of(c), 0.9) << simulator::name(c);
  }
}

void expect_doors_as_they_are(const simulator::Office& office, const GridMap& map) {
  for (const simulator::PlanRoom& room : office.rooms) {
    SCOPED_TRACE(testing::Message() << "door at " << room.door.middle.transpose());
    for (double aside = -0.2; aside <= 0.21; aside += map.resolution) {
      const int closed = cells_in_the_way(map, room.door, aside);
      if (room.door.open) {
        EXPECT_EQ(closed, 0) << aside;
      } else {
        EXPECT_GT(closed, 0) << aside;
      }
    }
  }
}

OccupancyPlan plan_of(const GridMap& map) {
  OccupancyPlan plan;
  plan.width = map.width;
  plan.height = map.height;
  plan.resolution = map.resolution;
  plan.origin = map.corner;
  for (const GridCell& cell : map.cells) {
    plan.cells.push_back(cell.state == CellState::occupied ? PlanCell::occupied
                         : cell.state == CellState::free   ? PlanCell::free
                                                           : PlanCell::unknown);
  }
  return plan;
}

}  // namespace kissmap
