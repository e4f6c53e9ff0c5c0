// SPDX-License-Identifier: GPL-3.0-or-later
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <QApplication>
#include <QStandardPaths>
#include <QTemporaryDir>
#include <cstring>

#include "core/io/import.h"
#include "ui/studio.h"
#include "ui/widgets/appearance.h"

int main(int argc, char** argv) {
    // importFile() starts this very program as its worker.
    if (argc > 1 && std::strcmp(argv[1], "import-worker") == 0) return imomushi::importWorkerMain();
    // Settings and caches of these tests are their own, and empty.
    QTemporaryDir home;
    qputenv("XDG_CONFIG_HOME", home.filePath(QStringLiteral("config")).toUtf8());
    qputenv("XDG_CACHE_HOME", home.filePath(QStringLiteral("cache")).toUtf8());
    QApplication application(argc, argv);
    imomushi::prepareStudio();
    imomushi::Appearance::instance().setLanguage(QStringLiteral("en"));
    return doctest::Context(argc, argv).run();
}
