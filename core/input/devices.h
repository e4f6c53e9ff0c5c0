// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/input/input_decoder.h"
#include "core/input/input_port.h"

namespace imomushi {

// Devices that are plugged in, of a protocol of which isOfDevices() is true.

/// A device that is there.
struct PluggedDevice {
    std::string device;  ///< what openDevice() knows it by, on this machine and, as far as can be told, on others
    std::string name;    ///< for people
    bool operator==(const PluggedDevice&) const = default;
};
/// In the order of the system. None is opened. Where devices cannot be had at all, none. The keyboard is not asked for: it is there wherever somebody has a KeyBoard.
std::vector<PluggedDevice> pluggedDevices(InputProtocol protocol);

/// PluggedDevice::name of a wanted device, whether it is there or not; empty if `wanted` is empty.
std::string deviceName(InputProtocol protocol, std::string_view wanted);

/// Waits for a device and hears it while it is plugged in; that it is missing is no error. `wanted`: PluggedDevice::device, or the name alone; empty: the first one that no other port has.
/// Errors: "no-devices", where the system has no such devices at all.
Result<std::unique_ptr<InputPort>> openDevice(InputProtocol protocol, std::string_view wanted);

}  // namespace imomushi
