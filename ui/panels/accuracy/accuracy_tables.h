// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QTableWidget>
#include <vector>

namespace imomushi {

struct AccuracyStudy;

/// The measured settings of a study, one a row.
class AccuracyTable : public QTableWidget {
    Q_OBJECT
public:
    explicit AccuracyTable(QWidget* parent = nullptr);
    void retranslate();
    /// `front`: points that no other one beats per frame, told apart. `tips`: of each point.
    void showStudy(const AccuracyStudy& study, const std::vector<std::size_t>& front, const std::vector<QString>& tips);
    /// Selects the row of a point.
    void setChosen(int point);

signals:
    void chosen(int point);
};

/// What each effect costs: predicted and measured.
class EffectCostTable : public QTableWidget {
    Q_OBJECT
public:
    explicit EffectCostTable(QWidget* parent = nullptr);
    void retranslate();
    void showStudy(const AccuracyStudy& study);
};

}  // namespace imomushi
