// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/widgets/wrapping_layout.h"

#include <algorithm>

namespace imomushi {

WrappingLayout::WrappingLayout(QWidget* parent, int between) : QLayout(parent) {
    setContentsMargins(0, 0, 0, 0);
    setSpacing(between);
}

WrappingLayout::~WrappingLayout() { qDeleteAll(items_); }

void WrappingLayout::addItem(QLayoutItem* item) {
    items_.push_back(item);
    invalidate();
}

QLayoutItem* WrappingLayout::itemAt(int index) const { return index >= 0 && index < count() ? items_[std::size_t(index)] : nullptr; }

QLayoutItem* WrappingLayout::takeAt(int index) {
    QLayoutItem* item = itemAt(index);
    if (item) items_.erase(items_.begin() + index);
    return item;
}

QSize WrappingLayout::sizeHint() const {
    QSize all(0, 0);
    for (const QLayoutItem* item : items_)
        if (!item->isEmpty()) all = QSize(all.width() + (all.width() > 0 ? spacing() : 0) + item->sizeHint().width(), std::max(all.height(), item->sizeHint().height()));
    return all;
}

QSize WrappingLayout::minimumSize() const {
    QSize least(0, 0);
    for (const QLayoutItem* item : items_)
        if (!item->isEmpty()) least = least.expandedTo(item->minimumSize());
    return least;
}

void WrappingLayout::setGeometry(const QRect& rect) {
    QLayout::setGeometry(rect);
    arrange(rect, true);
}

int WrappingLayout::arrange(const QRect& rect, bool put) const {
    std::vector<QLayoutItem*> seen;
    std::copy_if(items_.begin(), items_.end(), std::back_inserter(seen), [](const QLayoutItem* item) { return !item->isEmpty(); });
    int y = rect.y();
    for (std::size_t from = 0; from < seen.size();) {
        std::size_t to = from;
        int used = 0, high = 0;
        for (; to < seen.size(); ++to) {
            const QSize size = seen[to]->sizeHint();
            if (to > from && used + size.width() > rect.width()) break;
            used += size.width() + spacing();
            high = std::max(high, size.height());
        }
        int x = rect.x();
        for (std::size_t i = from; put && i < to; ++i) {
            const int wide = i + 1 == seen.size() ? rect.right() + 1 - x : std::min(seen[i]->sizeHint().width(), rect.width());
            seen[i]->setGeometry({x, y, wide, high});
            x += wide + spacing();
        }
        y += high + spacing();
        from = to;
    }
    return std::max(0, y - rect.y() - spacing());
}

}  // namespace imomushi
