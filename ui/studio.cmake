# SPDX-License-Identifier: GPL-3.0-or-later
# The studio: Qt 6.4 (Debian 12). models and tools know no widgets; widgets may use everything below them.
find_package(Qt6 6.4 REQUIRED COMPONENTS Widgets OpenGLWidgets Svg LinguistTools)
set(CMAKE_AUTOMOC ON)

imomushi_library(imomushi_models ui/models imomushi_document Qt6::Gui)
imomushi_library(imomushi_jobs ui/jobs imomushi_models)
imomushi_library(imomushi_tools ui/tools imomushi_models imomushi_scene)
imomushi_library(imomushi_viewport ui/viewport imomushi_tools Qt6::OpenGLWidgets)
imomushi_library(imomushi_panels ui/panels imomushi_viewport imomushi_jobs Qt6::Svg)
imomushi_library(imomushi_studio ui imomushi_panels)
