#pragma once

#include "core/model/error.h"

namespace paperbake {

/// Thrown when the energy of a sheet is not a finite number where the solver has to go on from. A
/// shorter step may do better; any other Error is not mended by that.
struct EnergyNotFinite : Error {
  explicit EnergyNotFinite(std::string place = "elastic step", std::string remedy = {})
      : Error(ErrorCode::simulation, std::move(place), "The energy of the sheet is not finite.",
              std::move(remedy)) {}
};

}  // namespace paperbake
