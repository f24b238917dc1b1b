// SPDX-License-Identifier: MIT
#include "kissmap/formats/g2o.hpp"

#include <cstdlib>

#include "fuzz/input_file.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"

KISSMAP_FUZZ_TARGET(g2o) {
  const FuzzInputFile file(input);
  for (const NegativeInformation negative :
       {NegativeInformation::refuse, NegativeInformation::drop_coupling}) {
    try {
      const GraphFile read = read_g2o(file.path(), negative);
      if (read.ids.size() != read.graph.map_from_node.size()) std::abort();
      for (const PoseGraphEdge& edge : read.graph.edges) {
        if (edge.from >= read.ids.size() || edge.to >= read.ids.size()) std::abort();
        if (!edge.information.allFinite()) std::abort();
      }
    } catch (const Error&) {
      // Refusing is an answer; crashing, hanging or an inconsistent graph is not.
    }
  }
}
