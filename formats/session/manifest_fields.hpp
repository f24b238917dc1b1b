// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "kissmap/formats/session.hpp"

namespace kissmap {

// Parts of session.json. Reading throws nlohmann::json::exception naming the field: a missing
// field, a wrong kind of value, and a number that would have to be changed to fit.

std::uint64_t unsigned_field(const nlohmann::json& object, const char* name);
double number_field(const nlohmann::json& object, const char* name);
bool bool_field(const nlohmann::json& object, const char* name);
std::string string_field(const nlohmann::json& object, const char* name);

/// Throws Error(internal) for a number JSON cannot hold.
double finite(double value, const char* name);

nlohmann::ordered_json log_to_json(const LogIdentity& log);
LogIdentity log_from_json(const nlohmann::json& object);

nlohmann::ordered_json counts_to_json(const SessionCounts& counts);
SessionCounts counts_from_json(const nlohmann::json& object);

nlohmann::ordered_json pack_to_json(const PackSummary& pack);
PackSummary pack_from_json(const nlohmann::json& object);

}  // namespace kissmap
