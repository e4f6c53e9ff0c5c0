// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/worker/frame.h"

#include "core/worker/bytes.h"

namespace imomushi::worker {
namespace {

constexpr std::string_view kMagic = "imo1";

}  // namespace

std::string frameHeader(FrameKind kind, std::uint64_t length) {
    ByteWriter w;
    w.raw(kMagic.data(), kMagic.size());
    w.value(static_cast<std::uint32_t>(kind));
    w.value(length);
    return w.take();
}

bool parseFrameHeader(std::string_view header, FrameKind& kind, std::uint64_t& length) {
    if (header.size() < kFrameHeader || header.substr(0, kMagic.size()) != kMagic) return false;
    ByteReader r(header.substr(kMagic.size(), kFrameHeader - kMagic.size()));
    const auto k = r.value<std::uint32_t>();
    length = r.value<std::uint64_t>();
    if (k < static_cast<std::uint32_t>(FrameKind::Keep) || k > static_cast<std::uint32_t>(FrameKind::NoMemory)) return false;
    kind = static_cast<FrameKind>(k);
    return true;
}

}  // namespace imomushi::worker
