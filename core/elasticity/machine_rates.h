// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace imomushi {

/// What one thread of this machine does while nothing disturbs it.
struct MachineRates {
    double secondsPerPair = 0.0;  ///< of the assembly: a collocation point and a triangle
    double flops = 0.0;           ///< of the products inside the factorisation, 1/s
    double bytesPerSecond = 0.0;  ///< read from memory
};

/// Measured in about 20 ms by the first caller, and by a few later ones again, since a machine may be disturbed just then: the best so far counts.
MachineRates machineRates();

}  // namespace imomushi
