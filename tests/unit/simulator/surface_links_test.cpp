// SPDX-License-Identifier: MIT
// Stretches of simulated drives, and what fitting their surfaces makes of drift put there by hand.
#include "kissmap/loop_closing/surface_links.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "kissmap/error.hpp"
#include "kissmap/loop_closing/loop_correction.hpp"
#include "kissmap/loop_closing/trajectory_refinement.hpp"
#include "simulator/scenario.hpp"
#include "simulator/simulator.hpp"

namespace kissmap::simulator {
namespace {

/// A drive through the office, with where it truly was.
struct Drive {
  std::vector<Rigid3> truth;     ///< map_from_lidar
  std::vector<Rigid3> odometry;  ///< what the builder was told instead
  std::vector<Stretch> stretches;

  std::vector<StretchPlace> places() const {
    std::vector<StretchPlace> found;
    for (const Stretch& stretch : stretches) found.push_back(stretch.place);
    return found;
  }
  std::vector<SurfaceLink> scan_links() const {
    std::vector<SurfaceLink> found;
    for (const Stretch& stretch : stretches) {
      found.insert(found.end(), stretch.scan_links.begin(), stretch.scan_links.end());
    }
    return found;
  }
  std::vector<SurfaceLink> links(const std::vector<Rigid3>& map_from_lidar, int threads) const {
    ThreadPool pool(threads);
    return link_surfaces(
        places(),
        [this](std::size_t i) { return stretches[i].surfels; },
        scan_links(),
        [&map_from_lidar](std::span<const SurfaceLink>) { return map_from_lidar; },
        pool);
  }
};

/// `waver` [rad]: by how much the poses given to the builder are turned at random, each for itself.
Drive drive(std::size_t scans, double waver = 0.0) {
  std::mt19937 random(7);
  std::normal_distribution<double> turn(0.0, waver > 0.0 ? waver : 1.0);
  const Simulator simulator = make_simulator({"office", "spinning16", "robot", 1, scans, 300, 1.0});
  Drive made;
  StretchBuilder builder(0.5, 100.0);
  const auto keep = [&made](std::optional<Stretch> stretch) {
    if (stretch) made.stretches.push_back(std::move(*stretch));
  };
  for (std::size_t i = 0; i < scans; ++i) {
    const Scan scan = simulator.scan(i);
    MappedScan mapped;
    mapped.stamp_ns = scan.stamp_ns;
    mapped.pose_stamp_ns =
        scan.stamp_ns + std::llround(1e9 * static_cast<double>(time_span(scan)->last));
    mapped.map_from_lidar = simulator.map_from_lidar(mapped.pose_stamp_ns);
    mapped.deskewed = true;
    made.truth.push_back(mapped.map_from_lidar);
    if (waver > 0.0) {
      Twist off = Twist::Zero();
      off.tail<3>() << turn(random), turn(random), turn(random);
      mapped.map_from_lidar = mapped.map_from_lidar * exp(off);
    }
    made.odometry.push_back(mapped.map_from_lidar);
    keep(builder.add(scan, mapped));
  }
  keep(builder.finish());
  return made;
}

/// The drive as an odometry with drift would have it: a graph at its optimum.
PoseGraph drifted(const std::vector<Rigid3>& truth, double times = 1.0) {
  PoseGraph graph;
  graph.map_from_node.push_back(truth.front());
  Twist error = Twist::Zero();
  error << 2e-4, -3e-4, 4e-4, 1e-4, -1e-4, 2e-4;
  for (std::uint32_t i = 1; i < truth.size(); ++i) {
    const Rigid3 motion = truth[i - 1].inverse() * truth[i] * exp(times * error);
    graph.map_from_node.push_back(graph.map_from_node.back() * motion);
    graph.edges.push_back(
        {i - 1, i, motion, odometry_information(motion.translation.norm()), EdgeKind::odometry});
  }
  return graph;
}

double largest_error(const std::vector<Rigid3>& found, const std::vector<Rigid3>& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    largest = std::max(largest, (found[i].translation - truth[i].translation).norm());
  }
  return largest;
}

class SurfaceLinks : public testing::Test {
 protected:
  static constexpr std::size_t scans = 400;
  static const Drive& the_drive() {
    static const Drive made = drive(scans);
    return made;
  }
};

TEST_F(SurfaceLinks, StretchesDivideTheWay) {
  const std::vector<StretchPlace> places = the_drive().places();
  ASSERT_GT(places.size(), 10U);
  EXPECT_EQ(places.front().first_scan, 0U);
  EXPECT_EQ(places.back().end_scan, scans);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i > 0) {
      EXPECT_EQ(places[i].first_scan, places[i - 1].end_scan);
    }
    EXPECT_GE(places[i].middle_scan, places[i].first_scan);
    EXPECT_LT(places[i].middle_scan, places[i].end_scan);
    EXPECT_GT(the_drive().stretches[i].surfels.size(), 100U);
    const Rigid3 way = the_drive().truth[places[i].first_scan].inverse() *
                       the_drive().truth[places[i].end_scan - 1];
    EXPECT_LT(way.translation.norm(), 1.0);
  }
}

TEST_F(SurfaceLinks, OfTruePosesAreTrue) {
  const std::vector<SurfaceLink> links = the_drive().links(the_drive().truth, 2);
  ASSERT_GT(links.size(), the_drive().stretches.size());
  std::vector<double> off;
  for (const SurfaceLink& link : links) {
    EXPECT_LT(link.reference_scan, link.query_scan);
    const Rigid3 truth =
        the_drive().truth[link.reference_scan].inverse() * the_drive().truth[link.query_scan];
    off.push_back((truth.inverse() * link.reference_from_query).translation.norm());
  }
  std::ranges::sort(off);
  EXPECT_LT(off[off.size() / 2], 0.02);
  EXPECT_LT(off[9 * off.size() / 10], 0.05);
}

TEST_F(SurfaceLinks, TakeAwayMostOfTheDrift) {
  const PoseGraph graph = drifted(the_drive().truth);
  const double before = largest_error(graph.map_from_node, the_drive().truth);
  ASSERT_GT(before, 0.15);
  const std::vector<SurfaceLink> links = the_drive().links(graph.map_from_node, 2);
  const double after = largest_error(fit_surfaces(graph, links), the_drive().truth);
  EXPECT_LT(after, before / 3.0);
}

TEST_F(SurfaceLinks, AreLookedForAgainWhereTheyMovedTheWay) {
  const PoseGraph graph = drifted(the_drive().truth, 4.0);
  std::vector<std::vector<SurfaceLink>> asked;
  ThreadPool pool(2);
  const std::vector<SurfaceLink> links = link_surfaces(
      the_drive().places(),
      [](std::size_t i) { return the_drive().stretches[i].surfels; },
      the_drive().scan_links(),
      [&](std::span<const SurfaceLink> found) {
        asked.emplace_back(found.begin(), found.end());
        return found.empty() ? graph.map_from_node : fit_surfaces(graph, found);
      },
      pool);
  ASSERT_GE(asked.size(), 3U);
  EXPECT_TRUE(asked[0].empty());
  EXPECT_GT(links.size(), asked[1].size()) << "what drift had kept apart";
  ASSERT_EQ(links.size(), asked.back().size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    EXPECT_EQ(links[i].query_scan, asked.back()[i].query_scan);
    EXPECT_EQ(links[i].reference_from_query.translation,
              asked.back()[i].reference_from_query.translation);
  }
  EXPECT_LT(largest_error(fit_surfaces(graph, links), the_drive().truth),
            0.1 * largest_error(graph.map_from_node, the_drive().truth));
}

TEST_F(SurfaceLinks, AreLookedForOnceWhereTheWayStaysAsItWas) {
  std::size_t asked = 0;
  ThreadPool pool(2);
  link_surfaces(
      the_drive().places(),
      [](std::size_t i) { return the_drive().stretches[i].surfels; },
      the_drive().scan_links(),
      [&](std::span<const SurfaceLink>) {
        ++asked;
        return the_drive().truth;
      },
      pool);
  EXPECT_EQ(asked, 2U);
}

TEST_F(SurfaceLinks, OfScansAloneAreKeptWhereThereIsOneStretch) {
  ThreadPool pool(1);
  const std::vector<SurfaceLink> scan_links = the_drive().scan_links();
  const std::vector<SurfaceLink> links = link_surfaces(
      std::vector<StretchPlace>{the_drive().places().front()},
      [](std::size_t i) { return the_drive().stretches[i].surfels; },
      std::span(scan_links).first(3),
      [](std::span<const SurfaceLink>) { return the_drive().truth; },
      pool);
  EXPECT_EQ(links.size(), 3U);
}

/// Root mean square of the angles between consecutive scans that are not those of the truth [rad].
double wavering(const std::vector<Rigid3>& found, const std::vector<Rigid3>& truth) {
  double squares = 0.0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const double off =
        ((truth[i - 1].inverse() * truth[i]).inverse() * (found[i - 1].inverse() * found[i]))
            .angle();
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(truth.size() - 1));
}

TEST(SurfaceLinksOfScans, TakeAwayHowOdometryWaversFromScanToScan) {
  constexpr double waver = 0.007;  // rad
  const Drive made = drive(200, waver);
  std::vector<double> off;
  for (const SurfaceLink& link : made.scan_links()) {
    const Rigid3 truth = made.truth[link.reference_scan].inverse() * made.truth[link.query_scan];
    off.push_back((truth.inverse() * link.reference_from_query).angle());
  }
  ASSERT_GT(off.size(), 150U) << "all but those of the first stretches";
  std::ranges::sort(off);
  EXPECT_LT(off[off.size() / 2], waver) << "of 2.4 times that between two scans";

  std::vector<ScanPlace> places;
  for (const Rigid3& pose : made.odometry) {
    places.push_back({0, made.odometry.front().inverse() * pose});
  }
  const std::vector<SurfaceLink> links = made.links(made.odometry, 2);
  const RefinedTrajectory refined = refine_trajectory(places, {Rigid3{}}, {}, {}, links);
  EXPECT_LT(wavering(refined.map_from_lidar, made.truth),
            0.65 * wavering(made.odometry, made.truth));
}

TEST_F(SurfaceLinks, FalseOnesAreRefused) {
  const PoseGraph graph = drifted(the_drive().truth);
  std::vector<SurfaceLink> links = the_drive().links(graph.map_from_node, 2);
  const std::vector<Rigid3> expected = fit_surfaces(graph, links);
  const std::size_t true_links = links.size();
  for (std::size_t i = 0; i < true_links; i += 10) {
    SurfaceLink wrong = links[i];
    wrong.reference_from_query.translation += Eigen::Vector3d(0.0, i % 20 == 0 ? 0.5 : 4.0, 0.0);
    links.push_back(wrong);
  }
  EXPECT_LT(largest_error(fit_surfaces(graph, links), expected), 0.03);
}

TEST_F(SurfaceLinks, AreTheSameForAnyNumberOfThreads) {
  const std::vector<SurfaceLink> one = the_drive().links(the_drive().truth, 1);
  for (const int threads : {2, 5}) {
    const std::vector<SurfaceLink> more = the_drive().links(the_drive().truth, threads);
    ASSERT_EQ(more.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(more[i].query_scan, one[i].query_scan);
      EXPECT_EQ(more[i].reference_from_query.translation, one[i].reference_from_query.translation);
      EXPECT_EQ(more[i].information, one[i].information);
    }
  }
}

TEST_F(SurfaceLinks, ToScansThatAreNotThereAreAnError) {
  const PoseGraph graph = drifted(the_drive().truth);
  EXPECT_THROW(
      fit_surfaces(graph, std::vector<SurfaceLink>{{3, scans, Rigid3{}, Information::Identity()}}),
      Error);
}

TEST(StretchBuilderTest, WhileTheSensorStandsThereIsOneStretch) {
  Scan scan;
  scan.stamp_instant = StampInstant::sweep_end;
  for (float y = -2.0F; y < 2.0F; y += 0.1F) {
    for (float z = -1.0F; z < 1.0F; z += 0.05F) scan.points.emplace_back(4.0F, y, z);
  }
  StretchBuilder builder(0.5, 100.0);
  for (int i = 0; i < 500; ++i) {
    MappedScan mapped;
    mapped.stamp_ns = mapped.pose_stamp_ns = 100'000'000LL * i;
    EXPECT_FALSE(builder.add(scan, mapped));
  }
  const std::optional<Stretch> stretch = builder.finish();
  ASSERT_TRUE(stretch);
  EXPECT_EQ(stretch->place.end_scan, 500U);
  for (const Eigen::Vector3f& normal : stretch->surfels.normals)
    EXPECT_NEAR(normal.x(), -1.0, 1e-3);
  EXPECT_FALSE(StretchBuilder(0.5, 100.0).finish());
}

TEST(StretchBuilderTest, LargeScansAreThinnedEvenly) {
  Scan scan;
  scan.time_source = TimeSource::recorded;
  for (int i = 0; i < 100'000; ++i) {
    scan.points.emplace_back(1.0F + static_cast<float>(i), 0.0F, 0.0F);
    scan.time_offsets.push_back(static_cast<float>(i));
  }
  const Scan thinned = thinned_for_stretches(scan);
  EXPECT_LE(thinned.points.size(), 12288U);
  EXPECT_GT(thinned.points.size(), 10'000U);
  ASSERT_EQ(thinned.time_offsets.size(), thinned.points.size());
  for (std::size_t i = 0; i < thinned.points.size(); ++i) {
    EXPECT_EQ(thinned.points[i].x(), 1.0F + thinned.time_offsets[i]);
  }
  scan.points.resize(12288);
  scan.time_offsets.resize(12288);
  EXPECT_EQ(thinned_for_stretches(scan).points.size(), 12288U);
}

}  // namespace
}  // namespace kissmap::simulator
