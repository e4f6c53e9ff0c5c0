// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace imomushi {

/// What one thread of this machine does while nothing disturbs it.
struct MachineRates {
    double secondsPerPair = 0.0;  ///< of the assembly: a collocation point and a triangle
    double flops = 0.0;           ///< of the products inside the factorisation, 1/s
    double bytesPerSecond = 0.0;  ///< read from memory
};

/// Measured in about 20 ms by the first caller, and by a few later ones again, since a machine may be disturbed just then: the best so far counts.
MachineRates machineRates();

/// Bytes that can still be had without swapping, and within the limit of the address space; the largest number where the system does not say.
std::size_t availableMemory();

}  // namespace imomushi
