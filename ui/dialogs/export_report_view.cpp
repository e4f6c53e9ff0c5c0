// SPDX-License-Identifier: GPL-3.0-or-later
#include "ui/dialogs/export_report_view.h"

#include <QDesktopServices>
#include <QFileInfo>
#include <QLabel>
#include <QLocale>
#include <QPushButton>
#include <QUrl>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "ui/models/effect_texts.h"
#include "ui/models/texts.h"
#include "ui/widgets/layouts.h"

namespace imomushi {
namespace {

using Role = Appearance::Role;

/// A file whose vertices are this near to the character's (over its diagonal) is the character.
constexpr double kSame = 1e-5;

/// A part of the diagonal: "0.31 %", and small ones as "2·10⁻⁶".
QString shareText(double share) {
    const QLocale locale;
    if (share >= 1e-4) return QStringLiteral("%1 %").arg(locale.toString(100.0 * share, 'g', 2));
    if (!(share > 0.0)) return QStringLiteral("0");
    int exponent = int(std::floor(std::log10(share)));
    long mantissa = std::lround(share / std::pow(10.0, exponent));
    if (mantissa == 10) {
        mantissa = 1;
        ++exponent;
    }
    static constexpr char16_t kDigits[] = u"⁰¹²³⁴⁵⁶⁷⁸⁹";
    QString power(u'⁻');
    for (const QChar digit : QString::number(-exponent)) power += QChar(kDigits[digit.digitValue()]);
    return QStringLiteral("%1·10%2").arg(mantissa).arg(power);
}

/// The same of an error {max_percent, ...} of the answer.
QString largest(const Json& error) { return shareText(error.at("max_percent").get<double>() / 100.0); }

}  // namespace

ExportReportView::ExportReportView(QWidget* parent) : QFrame(parent) {
    setObjectName(QStringLiteral("card"));
    title_ = styled(new QLabel(this), "section");
    title_->setWordWrap(true);
    lines_ = new QVBoxLayout;
    lines_->setSpacing(px(7));
    show_ = named(new QPushButton(tr("Show in folder"), this), "showInFolder");
    show_->setIcon(themedIcon(QStringLiteral("open")));
    show_->setAutoDefault(false);
    connect(show_, &QPushButton::clicked, this, [this] { QDesktopServices::openUrl(QUrl::fromLocalFile(QFileInfo(written_).absolutePath())); });
    fill(new QVBoxLayout(this), QMargins(px(16), px(12), px(16), px(12)), Spacing{px(8)}, title_, lines_, Stretch{},
         Share{show_, 0, Qt::AlignLeft});
}

void ExportReportView::begin(const QString& title) {
    title_->setText(title);
    while (QLayoutItem* item = lines_->takeAt(0)) {
        if (QLayout* line = item->layout())
            while (QLayoutItem* part = line->takeAt(0)) {
                delete part->widget();
                delete part;
            }
        delete item;
    }
    show_->hide();
}

void ExportReportView::add(const char* icon, Role role, const QString& text) {
    auto* sign = new QLabel(this);
    sign->setPixmap(themedIcon(QLatin1String(icon), role).pixmap(QSize(px(16), px(16)), devicePixelRatioF()));
    auto* words = new QLabel(text, this);
    words->setWordWrap(true);
    words->setTextInteractionFlags(Qt::TextSelectableByMouse);
    lines_->addLayout(fill(new QHBoxLayout, Spacing{px(8)}, Share{sign, 0, Qt::AlignTop}, Share{words, 1}));
}

void ExportReportView::showBefore(const Effects& effects) {
    begin(tr("Nothing written yet"));
    QStringList titles;
    for (std::size_t k = 0; k < kEffects; ++k)
        if (effects.has(EffectKind(k))) titles << effectTitle(EffectKind(k));
    if (!titles.isEmpty()) add("spring", Role::Muted, tr("This character has effects: %1. The report says what the file keeps of each.").arg(titles.join(tr(", "))));
    add("check", Role::Muted, tr("The written file is read back and compared with the character."));
}

void ExportReportView::showWriting(const QString& path) {
    written_ = path;
    begin(tr("Writing %1").arg(QFileInfo(path).fileName()));
}

void ExportReportView::showCancelled() {
    written_.clear();
    begin(tr("Cancelled: nothing was written."));
}

void ExportReportView::showFailure(const Error& error) {
    written_.clear();
    begin(tr("It could not be exported."));
    add("error", Role::Error, errorText(error));
}

void ExportReportView::showAnswer(const Json& answer) {
    const QLocale locale;
    const auto number = [&](const char* key) { return locale.toString(answer.at(key).get<qlonglong>()); };
    written_ = QString::fromStdString(answer.at("path").get<std::string>());
    const int files = answer.at("files").get<int>();
    const QString name = QFileInfo(written_).fileName(), bytes = bytesText(answer.at("bytes").get<double>());
    begin(files == 1 ? tr("Wrote %1, %2").arg(name, bytes) : tr("Wrote %n file(s) from %1 on, %2", nullptr, files).arg(name, bytes));
    const Json& check = answer.at("check");
    const bool same = check.at("max_percent").get<double>() / 100.0 <= kSame;
    // Other lines are of other frames, and may say more.
    const int frames = std::max(1, check.at("frames").get<int>());
    add(same ? "check" : "info", same ? Role::Good : Role::Info, tr("Read back and compared in %n frame(s): off by %1 of the diagonal at most", nullptr, frames).arg(largest(check)));
    QStringList characters;
    for (const Json& told : answer.at("written"))
        if (told.contains("character")) characters << QString::fromStdString(told["character"].get<std::string>());
    if (!characters.isEmpty()) add("check", Role::Good, tr("Written as the mesh of its file: %1").arg(characters.join(tr(", "))));
    for (const Json& told : answer.at("effects")) addEffect(told);
    if (answer.contains("render_mesh")) add("info", Role::Info, tr("Surface beside joints and attached parts: off by %1 at most").arg(largest(answer.at("render_mesh"))));
    if (answer.contains("skin")) add("info", Role::Info, tr("The skin is fitted: off by %1 at most").arg(largest(answer.at("skin"))));
    if (answer.contains("quantised")) add("info", Role::Info, tr("16 bits: off by %1 at most").arg(largest(answer.at("quantised"))));
    if (answer.contains("uncompressed_bytes")) add("check", Role::Good, tr("Compressed without loss: %1 before").arg(bytesText(answer.at("uncompressed_bytes").get<double>())));
    if (answer.contains("dropped_targets")) add("info", Role::Info, tr("Targets left out: off by %1 at most").arg(largest(answer.at("dropped_targets"))));
    for (const Json& warning : answer.at("warnings")) add("warning", Role::Warning, warningText(warning));
    QStringList facts{tr("%1 vertices").arg(number("vertices"))};
    if (answer.at("targets").get<int>() > 0) facts << tr("%1 targets").arg(number("targets"));
    facts << tr("%1 keys").arg(number("keys"));
    add("info", Role::Muted, facts.join(QStringLiteral(" · ")));
    show_->show();
}

void ExportReportView::addEffect(const Json& told) {
    const std::string name = told.at("effect").get<std::string>(), result = told.at("result").get<std::string>();
    const auto effect = effectNamed(name);
    const QString title = effect ? effectTitle(*effect) : QString::fromStdString(name);
    if (result == "exact") add("check", Role::Good, tr("%1: exact").arg(title));
    else if (result == "fitted") add("info", Role::Info, tr("%1: fitted, off by %2 at most").arg(title, largest(told.at("error"))));
    else add("warning", Role::Warning, tr("%1: left out").arg(title));
}

}  // namespace imomushi
