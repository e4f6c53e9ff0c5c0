// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/preferences_dialog.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QEvent>
#include <QFormLayout>
#include <QHeaderView>
#include <QKeySequenceEdit>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSettings>
#include <QTabWidget>
#include <QTableWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <map>

#include "core/document/document_history.h"
#include "ui/widgets/action_set.h"
#include "ui/widgets/appearance.h"
#include "ui/widgets/layouts.h"
#include "ui/widgets/scrolled.h"

namespace imomushi {

namespace {
const QString kHistoryDepth = QStringLiteral("history/depth");
const QString kVersionGigabytes = QStringLiteral("files/version-gigabytes");
const QString kMemoryGigabytes = QStringLiteral("responses/memory-gigabytes");
const QString kDiskGigabytes = QStringLiteral("responses/disk-gigabytes");
constexpr int kGigabytes[] = {0, 1, 2, 4, 8, 16, 32};

/// Bytes, as chosen; `usual` unless something was.
std::uintmax_t gigabytes(const QString& key, std::uintmax_t usual) {
    return static_cast<std::uintmax_t>(std::clamp(QSettings().value(key, int(usual >> 30)).toInt(), 0, 1'000'000)) << 30;
}

}  // namespace

int PreferencesDialog::historyDepth() { return std::clamp(QSettings().value(kHistoryDepth, DocumentHistory::kDepth).toInt(), 1, 1'000'000); }

VersionLimits PreferencesDialog::versionLimits() {
    VersionLimits limits;
    limits.bytes = gigabytes(kVersionGigabytes, limits.bytes);
    return limits;
}

ResponseStore::Limits PreferencesDialog::responseLimits() {
    ResponseStore::Limits limits;
    limits.memory = std::size_t(gigabytes(kMemoryGigabytes, limits.memory));
    limits.disk = gigabytes(kDiskGigabytes, limits.disk);
    return limits;
}

PreferencesDialog::PreferencesDialog(ActionSet& actions, QWidget* parent) : QDialog(parent), actions_(actions) {
    setLayout(new QVBoxLayout);
    rebuild();
    resize(withinScreen(*this, {px(560), px(520)}));
}

void PreferencesDialog::changeEvent(QEvent* event) {
    QDialog::changeEvent(event);
    // Later: the box whose choice changed the language is still talking.
    if (event->type() == QEvent::LanguageChange) QMetaObject::invokeMethod(this, &PreferencesDialog::rebuild, Qt::QueuedConnection);
}

QStringList PreferencesDialog::settings() {
    return {tr("Theme"), tr("Language"), tr("Size of the interface"), tr("Mouse in the view"), tr("Deform on"), tr("Picture"), tr("Steps that can be undone"), tr("Versions of a project"),
            tr("Memory for precomputed results"), tr("Disk space for precomputed results"), tr("Shortcuts")};
}

void PreferencesDialog::choose(const QString& setting) {
    for (auto* box : content_->findChildren<QComboBox*>())
        if (box->accessibleName() == setting) box->setFocus(Qt::OtherFocusReason);
    if (setting == tr("Shortcuts")) tabs_->setCurrentIndex(1);
}

void PreferencesDialog::rebuild() {
    const int tab = tabs_ ? tabs_->currentIndex() : 0;
    delete content_;
    setWindowTitle(tr("Preferences"));
    layout()->setContentsMargins(0, 0, 0, 0);
    content_ = new QWidget(this);
    layout()->addWidget(content_);
    tabs_ = new QTabWidget(content_);
    tabs_->setDocumentMode(true);

    auto* look = new QWidget;
    auto* form = new QFormLayout(look);
    form->setContentsMargins(px(18), px(20), px(18), px(18));
    form->setHorizontalSpacing(px(24));
    form->setVerticalSpacing(px(12));
    form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
    form->setLabelAlignment(Qt::AlignLeft | Qt::AlignVCenter);
    const auto row = [&](const QString& label, const QStringList& choices, int current, auto chosen) {
        auto* text = styled(new QLabel(label, look), "muted");
        auto* box = new QComboBox(look);
        box->addItems(choices);
        box->setCurrentIndex(current);
        box->setAccessibleName(label);
        text->setBuddy(box);
        form->addRow(text, box);
        connect(box, &QComboBox::activated, this, chosen);
    };
    Appearance& appearance = Appearance::instance();
    row(tr("Theme"), {tr("Dark"), tr("Light"), tr("High contrast")}, int(appearance.theme()), [](int i) { Appearance::instance().setTheme(Appearance::Theme(i)); });
    static constexpr const char* kLanguages[] = {"", "en", "ja"};
    int language = 0;
    for (int i = 0; i < 3; ++i)
        if (appearance.language() == QLatin1String(kLanguages[i])) language = i;
    row(tr("Language"), {tr("As the desktop"), QStringLiteral("English"), QStringLiteral("日本語")}, language,
        [](int i) { Appearance::instance().setLanguage(QLatin1String(kLanguages[i])); });
    static constexpr int kScales[] = {100, 125, 150, 175, 200, 250, 300};
    QStringList scales;
    int scale = 0;
    for (int i = 0; i < int(std::size(kScales)); ++i) {
        scales << QStringLiteral("%1 %").arg(kScales[i]);
        if (qRound(appearance.scale() * 100.0) == kScales[i]) scale = i;
    }
    row(tr("Size of the interface"), scales, scale, [](int i) { Appearance::instance().setScale(kScales[i] / 100.0); });
    row(tr("Mouse in the view"), {tr("Like Blender (middle button)"), tr("Like Maya (Alt and buttons)")}, QSettings().value(QStringLiteral("view/navigation"), 0).toInt(), [this](int i) {
        QSettings().setValue(QStringLiteral("view/navigation"), i);
        Q_EMIT navigationChanged(i);
        fillShortcuts();  // some keys are those of its studio
    });
    row(tr("Deform on"), {tr("Automatic"), tr("Processor"), tr("Graphics card")}, QSettings().value(QStringLiteral("view/deform-on"), 0).toInt(), [this](int i) {
        QSettings().setValue(QStringLiteral("view/deform-on"), i);
        Q_EMIT deformOnChanged(i);
    });
    row(tr("Picture"), {tr("Automatic"), tr("Fast, for slow machines"), tr("Fine at all times")}, QSettings().value(QStringLiteral("view/picture"), 0).toInt(), [this](int i) {
        QSettings().setValue(QStringLiteral("view/picture"), i);
        Q_EMIT pictureQualityChanged(i);
    });
    static constexpr int kDepths[] = {100, 300, DocumentHistory::kDepth, 3000, 10000};
    QStringList depths;
    int depth = 2;
    for (int i = 0; i < int(std::size(kDepths)); ++i) {
        depths << locale().toString(kDepths[i]);
        if (historyDepth() == kDepths[i]) depth = i;
    }
    row(tr("Steps that can be undone"), depths, depth, [this](int i) {
        QSettings().setValue(kHistoryDepth, kDepths[i]);
        Q_EMIT historyDepthChanged(kDepths[i]);
    });
    const auto space = [&](const QString& label, const QString& key, std::uintmax_t now, auto changed) {
        QStringList spaces;
        int current = 0;
        for (int i = 0; i < int(std::size(kGigabytes)); ++i) {
            spaces << (kGigabytes[i] == 0 ? tr("None") : tr("Up to %1 GB").arg(kGigabytes[i]));
            if (now >> 30 >= std::uintmax_t(kGigabytes[i])) current = i;
        }
        row(label, spaces, current, [this, key, changed](int i) {
            QSettings().setValue(key, kGigabytes[i]);
            Q_EMIT (this->*changed)();
        });
    };
    space(tr("Versions of a project"), kVersionGigabytes, versionLimits().bytes, &PreferencesDialog::versionsChanged);
    space(tr("Memory for precomputed results"), kMemoryGigabytes, responseLimits().memory, &PreferencesDialog::responsesChanged);
    space(tr("Disk space for precomputed results"), kDiskGigabytes, responseLimits().disk, &PreferencesDialog::responsesChanged);
    tabs_->addTab(new ScrolledRows(look, tabs_), tr("General"));

    auto* keys = new QWidget;
    table_ = new QTableWidget(keys);
    table_->setColumnCount(2);
    table_->setHorizontalHeaderLabels({tr("Command"), tr("Shortcut")});
    table_->horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
    table_->horizontalHeader()->setSectionResizeMode(0, QHeaderView::Stretch);
    table_->horizontalHeader()->setSectionResizeMode(1, QHeaderView::Fixed);
    table_->horizontalHeader()->resizeSection(1, px(190));
    table_->verticalHeader()->hide();
    table_->setShowGrid(false);
    table_->setSelectionMode(QAbstractItemView::NoSelection);
    table_->setEditTriggers(QAbstractItemView::NoEditTriggers);
    table_->setAccessibleName(tr("Shortcuts"));
    conflict_ = styled(new QLabel(keys), "warning");
    conflict_->setWordWrap(true);
    auto* reset = new QPushButton(themedIcon(QStringLiteral("reset")), tr("Reset all shortcuts"), keys);
    connect(reset, &QPushButton::clicked, this, [this] {
        actions_.resetShortcuts();
        fillShortcuts();
    });
    auto* foot = fill(new QHBoxLayout, Share{conflict_, 1}, reset);
    fill(new QVBoxLayout(keys), QMargins(px(4), px(12), px(4), px(4)), table_, foot);
    tabs_->addTab(keys, tr("Shortcuts"));
    tabs_->setCurrentIndex(tab);
    fillShortcuts();

    auto* buttons = new QDialogButtonBox(content_);
    auto* close = buttons->addButton(tr("Close"), QDialogButtonBox::RejectRole);
    close->setDefault(true);
    connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::accept);
    fill(new QVBoxLayout(content_), QMargins(px(16), px(12), px(16), px(14)), tabs_, Space{px(8)}, buttons);
}

void PreferencesDialog::fillShortcuts() {
    const auto& entries = actions_.entries();
    table_->setRowCount(int(entries.size()));
    QPixmap empty(px(16), px(16));
    empty.fill(Qt::transparent);
    const QIcon noIcon(empty);  // names stand in one line with and without
    for (int i = 0; i < int(entries.size()); ++i) {
        const auto& entry = entries[std::size_t(i)];
        auto* name = new QTableWidgetItem(entry.action->icon().isNull() ? noIcon : entry.action->icon(), commandName(*entry.action));
        name->setFlags(Qt::ItemIsEnabled);
        table_->setItem(i, 0, name);
        auto* edit = new QKeySequenceEdit(entry.action->shortcut(), table_);
        edit->setClearButtonEnabled(true);
        edit->setAccessibleName(name->text());
        if (auto* line = edit->findChild<QLineEdit*>()) {
            line->setPlaceholderText(tr("Press keys"));
            line->setAccessibleName(name->text());
        }
        connect(edit, &QKeySequenceEdit::editingFinished, this, [this, edit, id = entry.id] {
            actions_.setShortcut(id, edit->keySequence());
            markConflicts();
        });
        table_->setCellWidget(i, 1, edit);
        table_->setRowHeight(i, px(36));
    }
    markConflicts();
}

void PreferencesDialog::markConflicts() {
    std::map<QString, QStringList> users;
    for (const auto& entry : actions_.entries())
        for (const QKeySequence& keys : entry.action->shortcuts())
            if (!keys.isEmpty()) users[keys.toString(QKeySequence::NativeText)] << commandName(*entry.action);
    QStringList lines;
    for (const auto& [keys, names] : users)
        if (names.size() > 1) lines << tr("%1 is used by: %2", "shortcut, commands").arg(keys, names.join(QStringLiteral(", ")));
    conflict_->setText(lines.join(u'\n'));
}

}  // namespace imomushi
