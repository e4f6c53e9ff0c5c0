// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/input/osc_packet.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>

#include "core/base/finite.h"

namespace imomushi {

namespace {

constexpr int kDeepest = 4;
constexpr std::size_t kUnit = 4;  // bytes: everything in a packet is a multiple of this
constexpr std::string_view kBundle("#bundle\0", 8);
constexpr std::size_t kTimeTag = 8;

/// Takes parts from the front of bytes, which have a size that is a multiple of kUnit. None: there are not so many.
class OscReader {
public:
    explicit OscReader(std::string_view bytes) : left_(bytes) {}
    [[nodiscard]] bool done() const { return left_.empty(); }
    std::optional<std::string_view> bytes(std::size_t count) {
        if (count > left_.size()) return std::nullopt;
        const std::string_view taken = left_.substr(0, count);
        left_.remove_prefix(count);
        return taken;
    }
    /// `Unsigned`: as many bytes, high byte first.
    template <class Unsigned>
    std::optional<Unsigned> number() {
        const auto taken = bytes(sizeof(Unsigned));
        if (!taken) return std::nullopt;
        Unsigned value = 0;
        for (const char c : *taken) value = static_cast<Unsigned>(value << 8 | static_cast<unsigned char>(c));
        return value;
    }
    /// Up to its zero, which must be there, as all that fills the unit must be.
    std::optional<std::string_view> text() {
        const std::size_t length = left_.find('\0');
        if (length == std::string_view::npos) return std::nullopt;
        const auto taken = bytes((length / kUnit + 1) * kUnit);
        return taken ? std::optional(taken->substr(0, length)) : std::nullopt;
    }
    /// With its size before it.
    bool skipBlob() {
        const auto size = number<std::uint32_t>();
        return size && bytes((std::size_t{*size} + kUnit - 1) / kUnit * kUnit);
    }

private:
    std::string_view left_;
};

/// A number that is not finite becomes one of a kind: bits from outside are not computed with.
template <class Number>
double sane(Number value) {
    return isFinite(value) ? static_cast<double>(value) : std::numeric_limits<double>::quiet_NaN();
}

/// Adds the argument of a type to a message. False: it is not whole, or of a type that nobody knows the size of.
bool readArgument(char type, OscReader& in, OscMessage& to) {
    OscMessage::Argument made;
    switch (type) {
        case 'i':
            if (const auto bits = in.number<std::uint32_t>())
                made.number = static_cast<std::int32_t>(*bits);
            else
                return false;
            break;
        case 'h':
            if (const auto bits = in.number<std::uint64_t>())
                made.number = static_cast<double>(static_cast<std::int64_t>(*bits));
            else
                return false;
            break;
        case 'f':
            if (const auto bits = in.number<std::uint32_t>())
                made.number = sane(std::bit_cast<float>(*bits));
            else
                return false;
            break;
        case 'd':
            if (const auto bits = in.number<std::uint64_t>())
                made.number = sane(std::bit_cast<double>(*bits));
            else
                return false;
            break;
        case 's':
        case 'S':
            if (const auto text = in.text())
                made.isText = true, made.text = *text;
            else
                return false;
            break;
        case 'T': made.number = 1.0; break;
        case 'F': break;
        case 'N':
        case 'I':
        case '[':
        case ']': return true;
        case 'c':
        case 'r':
        case 'm': return in.bytes(4).has_value();
        case 't': return in.bytes(8).has_value();
        case 'b': return in.skipBlob();
        default: return false;
    }
    if (to.count == OscMessage::kMost)
        to.more = true;
    else
        to.arguments[to.count++] = made;
    return true;
}

bool readMessage(std::string_view bytes, const std::function<bool(const OscMessage&)>& take) {
    OscReader in(bytes);
    OscMessage message;
    const auto address = in.text();
    if (!address || address->empty() || address->front() != '/') return false;
    message.address = *address;
    if (in.done()) return take(message);  // old senders leave the types of no arguments out
    const auto types = in.text();
    if (!types || types->empty() || types->front() != ',') return false;
    for (const char type : types->substr(1))
        if (!readArgument(type, in, message)) return false;
    return in.done() && take(message);
}

bool readElement(std::string_view bytes, int depth, const std::function<bool(const OscMessage&)>& take) {
    if (bytes.empty() || bytes.size() % kUnit != 0) return false;
    if (!bytes.starts_with(kBundle)) return readMessage(bytes, take);
    OscReader in(bytes.substr(kBundle.size()));
    if (depth == kDeepest || !in.bytes(kTimeTag)) return false;
    while (!in.done()) {
        const auto size = in.number<std::uint32_t>();
        const auto element = size ? in.bytes(*size) : std::nullopt;
        if (!element || !readElement(*element, depth + 1, take)) return false;
    }
    return true;
}

void addText(std::string& to, std::string_view text) {
    to += text;
    to.append(4 - text.size() % 4, '\0');
}

void addNumber(std::string& to, std::uint32_t bits) {
    for (int shift = 24; shift >= 0; shift -= 8) to += static_cast<char>(bits >> shift & 0xFF);
}

}  // namespace

std::string oscMessage(std::string_view address, std::string_view text, std::int32_t number) {
    std::string made;
    for (const std::string_view part : {address, std::string_view(",si"), text}) addText(made, part);
    addNumber(made, static_cast<std::uint32_t>(number));
    return made;
}

void OscBundle::begin(const Send& send) {
    send_ = &send;
    bytes_.clear();
}

void OscBundle::end() {
    if (!bytes_.empty()) (*send_)(std::as_bytes(std::span(bytes_)));
    bytes_.clear();
}

void OscBundle::put(std::string_view address, std::optional<std::string_view> text, std::optional<std::int32_t> number, std::initializer_list<float> numbers) {
    message_.clear();
    addText(message_, address);
    const std::size_t tags = message_.size();
    message_ += ',';
    if (text) message_ += 's';
    if (number) message_ += 'i';
    message_.append(numbers.size(), 'f');
    message_.append(4 - (message_.size() - tags) % 4, '\0');
    if (text) addText(message_, *text);
    if (number) addNumber(message_, static_cast<std::uint32_t>(*number));
    for (const float one : numbers) addNumber(message_, std::bit_cast<std::uint32_t>(one));
    if (bytes_.size() + 4 + message_.size() > kMostBytes) end();
    if (bytes_.empty()) {
        addText(bytes_, "#bundle");
        addNumber(bytes_, 0);
        addNumber(bytes_, 1);  // at once
    }
    addNumber(bytes_, static_cast<std::uint32_t>(message_.size()));
    bytes_ += message_;
}

bool readOscPacket(std::span<const std::byte> packet, const std::function<bool(const OscMessage&)>& take) {
    return readElement({reinterpret_cast<const char*>(packet.data()), packet.size()}, 0, take);
}

}  // namespace imomushi
