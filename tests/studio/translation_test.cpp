// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <QCoreApplication>
#include <QDirIterator>
#include <QFile>
#include <QProcess>
#include <QRegularExpression>
#include <QTemporaryDir>
#include <QTranslator>
#include <QXmlStreamReader>
#include <set>
#include <string>

#include "ui/models/texts.h"

namespace {

struct Messages {
    std::set<std::string> all;         ///< context, source and comment in one
    std::set<std::string> unfinished;  ///< those without a finished, full translation
};

Messages read(const QString& path) {
    Messages found;
    QFile file(path);
    REQUIRE(file.open(QIODevice::ReadOnly));
    QXmlStreamReader xml(&file);
    QString context, source, comment;
    while (!xml.atEnd()) {
        if (xml.readNext() != QXmlStreamReader::StartElement) continue;
        if (xml.name() == u"name") context = xml.readElementText();
        else if (xml.name() == u"message") source = comment = QString();
        else if (xml.name() == u"source") source = xml.readElementText();
        else if (xml.name() == u"comment") comment = xml.readElementText();
        else if (xml.name() == u"translation") {
            const bool open = xml.attributes().hasAttribute(QStringLiteral("type"));
            const QString text = xml.readElementText(QXmlStreamReader::IncludeChildElements);
            const std::string key = (context + u'\x1f' + source + u'\x1f' + comment).toStdString();
            found.all.insert(key);
            if (open || text.trimmed().isEmpty()) found.unfinished.insert(key);
            // What is filled in must be filled in by the translation, too.
            for (const char* place : {"%1", "%2", "%3", "%4", "%n"})
                if (source.contains(QLatin1String(place)) != text.contains(QLatin1String(place)) && !source.contains(QStringLiteral("%L2"))) found.unfinished.insert(key);
        }
    }
    REQUIRE(!xml.hasError());
    return found;
}

}  // namespace

TEST_CASE("translations: Japanese has every text of the studio, finished, and no other") {
    const QString kept = QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/translations/imomushi_ja.ts");
    QTemporaryDir folder;
    const QString fresh = folder.filePath(QStringLiteral("imomushi_ja.ts"));
    REQUIRE(QFile::copy(kept, fresh));
    QProcess lupdate;
    lupdate.start(QStringLiteral(IMOMUSHI_LUPDATE), {QStringLiteral("-silent"), QStringLiteral("-no-obsolete"), QStringLiteral("-locations"), QStringLiteral("none"), QStringLiteral("-extensions"),
                                                    QStringLiteral("cpp,h"), QStringLiteral("-I"), QStringLiteral(IMOMUSHI_SOURCE_DIR), QStringLiteral(IMOMUSHI_SOURCE_DIR "/ui"), QStringLiteral(IMOMUSHI_SOURCE_DIR "/core"),
                                                    QStringLiteral("-tr-function-alias"), QStringLiteral("QT_TRANSLATE_NOOP+=IMOMUSHI_TEXT"), QStringLiteral("-ts"), fresh});
    REQUIRE(lupdate.waitForFinished(60000));
    REQUIRE(lupdate.exitCode() == 0);
    const Messages ours = read(kept), needed = read(fresh);
    for (const std::string& message : needed.all)
        if (!ours.all.contains(message)) FAIL_CHECK("not in the Japanese translation: ", message);
    for (const std::string& message : ours.all)
        if (!needed.all.contains(message)) FAIL_CHECK("translated, but nowhere in the studio: ", message);
    for (const std::string& message : ours.unfinished) FAIL_CHECK("not finished in Japanese: ", message);
    CHECK(needed.all.size() > 100);
    // English as it is in the source says "(s)" where one thing and many are told apart.
    const Messages english = read(QStringLiteral(IMOMUSHI_SOURCE_DIR "/assets/translations/imomushi_en.ts"));
    for (const std::string& message : needed.all)
        if (message.find("(s)") != std::string::npos && !english.all.contains(message)) FAIL_CHECK("without a plural in English: ", message);
    for (const std::string& message : english.all)
        if (!needed.all.contains(message)) FAIL_CHECK("a plural, but nowhere in the studio: ", message);
}

TEST_CASE("translations: every reason for a failure has a sentence in Japanese") {
    QTranslator japanese;
    REQUIRE(japanese.load(QStringLiteral(":/translations/imomushi_ja.qm")));
    REQUIRE(QCoreApplication::installTranslator(&japanese));
    // Codes stand where failures are made, or in constants with names of their own.
    const QRegularExpression made(QStringLiteral("fail\\(\"([a-z-]+)\"|constexpr const char\\* k[A-Za-z]+ = \"([a-z]+-[a-z-]+)\""));
    std::set<std::string> codes;
    for (const char* room : {"/core", "/ui"}) {
        QDirIterator files(QStringLiteral(IMOMUSHI_SOURCE_DIR) + QLatin1String(room), {QStringLiteral("*.cpp"), QStringLiteral("*.h")}, QDir::Files, QDirIterator::Subdirectories);
        while (files.hasNext()) {
            QFile file(files.next());
            REQUIRE(file.open(QIODevice::ReadOnly));
            for (auto found = made.globalMatch(QString::fromUtf8(file.readAll())); found.hasNext();) {
                const auto match = found.next();
                codes.insert((match.captured(1).isEmpty() ? match.captured(2) : match.captured(1)).toStdString());
            }
        }
    }
    CHECK(codes.size() > 60);
    for (const std::string& code : codes)
        if (imomushi::errorText({code, "In English."}) == QStringLiteral("In English.")) FAIL_CHECK("no sentence for ", code);
    QCoreApplication::removeTranslator(&japanese);
}
