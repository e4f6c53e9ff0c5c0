// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <QWidget>

class QGridLayout;
class QLabel;

namespace imomushi {

class RecentFiles;

/// The first thing seen: three ways to begin (from a sample, a mesh, a rigged file), samples in one click, recent projects with pictures.
class StartPage : public QWidget {
    Q_OBJECT
public:
    explicit StartPage(RecentFiles& recent, QWidget* parent = nullptr);
    /// A file is held over the window: it may be dropped.
    void setDropping(bool dropping);

signals:
    void newWanted();
    void openWanted();
    void meshWanted();
    void riggedFileWanted();
    void fileWanted(const QString& path);
    void replayWanted(const QString& title, const QString& script);

protected:
    void changeEvent(QEvent* event) override;
    void resizeEvent(QResizeEvent* event) override;
    void showEvent(QShowEvent* event) override;

private:
    void rebuild();
    /// A button on the card of a sample.
    void addReplay(QWidget& tile, const QString& title, const QString& script);
    [[nodiscard]] int columnsThatFit() const;
    [[nodiscard]] int tileWidthThatFits() const;
    [[nodiscard]] int room() const;  ///< for cards, pixels

    RecentFiles& recent_;
    QWidget* content_ = nullptr;
    QWidget* drop_ = nullptr;
    int columns_ = 0, tileWidth_ = 0;
};

/// The name of a sample as artists read it.
QString sampleTitle(const QString& name);

}  // namespace imomushi
