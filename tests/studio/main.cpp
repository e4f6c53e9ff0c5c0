// SPDX-License-Identifier: GPL-3.0-or-later
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <QApplication>
#include <QSettings>
#include <cstring>

#include "core/worker/worker.h"
#include "tests/studio/victim.h"
#include "tests/studio/window.h"
#include "tests/support/left_out.h"
#include "tests/support/own_home.h"
#include "ui/studio.h"
#include "ui/widgets/appearance.h"
#include "ui/window/guarded_application.h"

int main(int argc, char** argv) {
    // This very program is its worker.
    if (argc > 1 && std::strcmp(argv[1], "worker") == 0) return imomushi::workerMain();
    imomushi::setWorkerProgram("/proc/self/exe");
    if (argc > 2 && std::strcmp(argv[1], "victim") == 0) return imomushi::studioVictim(argc, argv, argv[2], argc > 3);  // in the home of the test that kills it
    imomushi::ownHome();
    imomushi::GuardedApplication application(argc, argv);
    imomushi::prepareStudio();
    QSettings().setValue(QStringLiteral("precompute/soft-at-once"), false);  // cases that are about it turn it on
    QSettings().setValue(QStringLiteral("import/soft-at-first"), false);
    QSettings().setValue(QStringLiteral("view/picture"), 1);  // four fifths of the time goes into drawing; pictures that are grabbed are fine ones
    imomushi::Appearance::instance().setLanguage(QStringLiteral("en"));
    const int status = imomushi::statusOf(doctest::Context(argc, argv).run());
    imomushi::SharedStudio::instance().close();
    return status;
}
