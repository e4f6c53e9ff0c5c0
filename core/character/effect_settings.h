// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <concepts>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/result.h"

/// Marks an English text that people see. The studio translates it in this context (lupdate takes the name for QT_TRANSLATE_NOOP); core shows it as it is.
#define IMOMUSHI_TEXT(context, text) text

namespace imomushi {

struct Frame;
class FrameJobs;
struct ElementTables;

/// The settings of one effect (the manual's effects), which make the effect's job of a frame. Each effect derives its own in the header of its job, by EffectOf.
struct EffectSettings {
    std::vector<char> elements;  ///< per element of the character, 0: it does not act there; empty: it acts on all
    bool automatic = false;      ///< only where and while a pose calls for it, as far as it does (PoseWatch); effects that know how

    EffectSettings() = default;
    EffectSettings(const EffectSettings&) = default;
    EffectSettings& operator=(const EffectSettings&) = default;
    virtual ~EffectSettings() = default;

    [[nodiscard]] bool on(std::size_t element) const { return elements.empty() || (element < elements.size() && elements[element]); }
    /// The name under which statistics tell its time; that of the document.
    [[nodiscard]] virtual std::string_view name() const = 0;
    /// Which rule the numbers break. Errors: "bad-value".
    [[nodiscard]] virtual Result<void> validate() const = 0;
    /// Adds what it needs of an element on which it acts: columns of its response, and tables for frames (element_runtime.h).
    virtual void ask(ElementTables&) const {}
    /// Adds its job to those of a frame whose joints and elements are built; none where it has nothing to do. Errors: "bad-value".
    [[nodiscard]] virtual Result<void> addJob(Frame&, FrameJobs&) const { return {}; }
};

/// A number of an effect, or a vector of three within the same range, as commands, files and the studio know it.
struct EffectProperty {
    std::string_view name;  ///< of commands and files
    std::string_view unit;  ///< "Hz", "s", "m", "m/s^2", "Pa"; empty: a ratio
    double low = 0.0, high = 1.0;
    const char *title, *help;  ///< IMOMUSHI_TEXT("Effects", ...): a name for people, and one sentence
    bool whole = false;        ///< whole numbers
    bool rebuilds = false;     ///< the response depends on it: the character is built anew; other numbers change while it moves
    int size = 1;              ///< 1 or 3
    double* (*at)(EffectSettings&) = nullptr;  ///< the first of its numbers in the settings of its effect
};

/// Each number lies within the range of its property. Errors: "bad-value".
Result<void> checkNumbers(EffectSettings& settings, std::span<const EffectProperty> properties);

/// `T` derives from this and has `kName`, and for people `kTitle` and `kHelp`, one sentence: IMOMUSHI_TEXT("Effects", ...). Where it has numbers, they are its
/// members; their values at first are the defaults, and `static constexpr auto properties()` lists them once for all: an array of number<&T::member>(...).
template <class T>
struct EffectOf : EffectSettings {
    [[nodiscard]] std::string_view name() const final { return T::kName; }
    [[nodiscard]] Result<void> validate() const override {
        T copy = static_cast<const T&>(*this);
        const auto properties = T::properties();
        return checkNumbers(copy, properties);
    }
    static constexpr std::array<EffectProperty, 0> properties() { return {}; }

protected:
    /// The property of a member, a double or a Vec3.
    template <auto Member>
    static constexpr EffectProperty number(std::string_view name, std::string_view unit, double low, double high, const char* title, const char* help,
                                           bool whole = false, bool rebuilds = false) {
        constexpr bool one = std::is_same_v<std::remove_cvref_t<decltype(std::declval<T&>().*Member)>, double>;
        return {name, unit, low, high, title, help, whole, rebuilds, one ? 1 : 3, [](EffectSettings& settings) -> double* {
                    if constexpr (one)
                        return &(static_cast<T&>(settings).*Member);
                    else
                        return (static_cast<T&>(settings).*Member).data();
                }};
    }
};

/// The same settings as those of effect `T`, null: they are of another effect.
template <class T>
const T* settingsAs(const EffectSettings& settings) {
    return settings.name() == T::kName ? static_cast<const T*>(&settings) : nullptr;
}

/// The effects of a character. Which of them it has, and where, is fixed when it is built; their numbers may change while it moves (Character::tune()).
class CharacterEffects {
public:
    /// Null: it has no such effect.
    template <class T>
    [[nodiscard]] const T* find() const {
        for (const auto& s : all_)
            if (const T* found = settingsAs<T>(*s)) return found;
        return nullptr;
    }
    template <class T>
    [[nodiscard]] bool has() const {
        return find<T>() != nullptr;
    }
    /// Adds an effect, or replaces its settings.
    void set(std::shared_ptr<const EffectSettings> settings) {
        erase(settings->name());
        all_.push_back(std::move(settings));
    }
    template <std::derived_from<EffectSettings> T>
    void set(T settings) {
        set(std::shared_ptr<const EffectSettings>(std::make_shared<const T>(std::move(settings))));
    }
    template <class T>
    void erase() {
        erase(T::kName);
    }

    [[nodiscard]] auto begin() const { return all_.begin(); }
    [[nodiscard]] auto end() const { return all_.end(); }

private:
    void erase(std::string_view name) {
        std::erase_if(all_, [name](const auto& s) { return s->name() == name; });
    }
    std::vector<std::shared_ptr<const EffectSettings>> all_;
};

}  // namespace imomushi
