// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QBoxLayout>
#include <concepts>

namespace imomushi {

/// What was just made, with a name for style sheets and tests.
template <class Object>
Object* named(Object* object, const char* name) {
    object->setObjectName(QLatin1String(name));
    return object;
}

/// The same with its part in the style sheet: "muted", "section", "title", ...
template <class Widget>
Widget* styled(Widget* widget, const char* role) {
    widget->setProperty("role", role);
    return widget;
}

/// A widget or layout that takes up a share of what is left over.
template <class Item>
struct Share {
    Item* item;
    int stretch;
    Qt::Alignment alignment = {};
};
/// Pixels between all items of a layout; between two of them.
struct Spacing {
    int pixels;
};
struct Space {
    int pixels;
};
struct Stretch {};

template <class Item>
void put(QBoxLayout& layout, const Share<Item>& share) {
    if constexpr (std::derived_from<Item, QLayout>)
        layout.addLayout(share.item, share.stretch);
    else
        layout.addWidget(share.item, share.stretch, share.alignment);
}
inline void put(QBoxLayout& layout, QWidget* widget) { layout.addWidget(widget); }
inline void put(QBoxLayout& layout, QLayout* inner) { layout.addLayout(inner); }
inline void put(QBoxLayout& layout, const QMargins& margins) { layout.setContentsMargins(margins); }
inline void put(QBoxLayout& layout, Spacing spacing) { layout.setSpacing(spacing.pixels); }
inline void put(QBoxLayout& layout, Space space) { layout.addSpacing(space.pixels); }
inline void put(QBoxLayout& layout, Stretch) { layout.addStretch(1); }

/// Puts items into a layout, one after the other: widgets, layouts, and what stands above.
template <class Layout, class... Items>
Layout* fill(Layout* layout, const Items&... items) {
    (put(*layout, items), ...);
    return layout;
}

}  // namespace imomushi
