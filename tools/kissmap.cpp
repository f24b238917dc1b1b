// SPDX-License-Identifier: MIT
#include <cstdio>

#include "kissmap/version.hpp"

int main() {
  std::printf("kissmap %s\n", kissmap::version());
}
