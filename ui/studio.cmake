# SPDX-License-Identifier: GPL-3.0-or-later
# The studio: Qt 6.4 (Debian 12). models, jobs, picking and tools know no widgets; widgets know no document; panels and dialogs know neither each other nor the window.
find_package(Qt6 6.4 REQUIRED COMPONENTS Widgets OpenGLWidgets Svg LinguistTools)
set(CMAKE_AUTOMOC ON)

imomushi_precompiled(imomushi_precompiled_studio)
target_link_libraries(imomushi_precompiled_studio PRIVATE Qt6::Gui)
target_precompile_headers(imomushi_precompiled_studio PRIVATE <QAction> <QEvent> <QLocale> <QMouseEvent> <QObject> <QPainter> <QSettings> <QString> <QTimer>)
set(IMOMUSHI_PRECOMPILED imomushi_precompiled_studio)

imomushi_library(imomushi_models ui/models imomushi_commands Qt6::Gui)
# Its texts have the translator's context of texts.cpp.
set_source_files_properties(${PROJECT_SOURCE_DIR}/ui/models/effect_texts.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
target_compile_definitions(imomushi_models PRIVATE IMOMUSHI_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
imomushi_library(imomushi_jobs ui/jobs imomushi_models imomushi_reports)
imomushi_library(imomushi_picking ui/picking imomushi_models imomushi_scene)
imomushi_library(imomushi_tools ui/tools imomushi_jobs imomushi_picking)
imomushi_library(imomushi_widgets ui/widgets imomushi_base Qt6::Widgets Qt6::Svg)
imomushi_library(imomushi_viewport ui/viewport imomushi_tools imomushi_widgets Qt6::OpenGLWidgets)
imomushi_library(imomushi_panels ui/panels imomushi_widgets imomushi_jobs)
imomushi_library(imomushi_inspector ui/panels/inspector imomushi_widgets imomushi_tools)
# One header for all forms: moc finds by itself only those that have a source of the same name.
target_sources(imomushi_inspector PRIVATE ${PROJECT_SOURCE_DIR}/ui/panels/inspector/inspector_forms.h)
imomushi_library(imomushi_live_panel ui/panels/live imomushi_widgets imomushi_jobs)
imomushi_library(imomushi_accuracy_panel ui/panels/accuracy imomushi_widgets imomushi_jobs imomushi_viewport)
imomushi_library(imomushi_dialogs ui/dialogs imomushi_widgets imomushi_jobs imomushi_viewport)
imomushi_library(imomushi_window ui/window imomushi_panels imomushi_inspector imomushi_accuracy_panel imomushi_live_panel imomushi_dialogs imomushi_viewport)
imomushi_library(imomushi_studio ui imomushi_window)

# Icons and translations are part of the program: nothing has to be found at run time.
file(GLOB icons CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/assets/icons/*.svg)
file(GLOB translations CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/assets/translations/*.ts)
set(resources "<RCC><qresource prefix=\"/\">\n")
foreach(icon ${icons})
    get_filename_component(name ${icon} NAME)
    string(APPEND resources "<file alias=\"icons/${name}\">${icon}</file>\n")
endforeach()
set(qms)
foreach(ts ${translations})
    get_filename_component(name ${ts} NAME_WE)
    set(qm ${CMAKE_CURRENT_BINARY_DIR}/${name}.qm)
    add_custom_command(OUTPUT ${qm} COMMAND Qt6::lrelease -silent ${ts} -qm ${qm} DEPENDS ${ts} VERBATIM)
    string(APPEND resources "<file alias=\"translations/${name}.qm\">${qm}</file>\n")
    list(APPEND qms ${qm})
endforeach()
string(APPEND resources "</qresource></RCC>\n")
file(CONFIGURE OUTPUT studio.qrc CONTENT "${resources}" @ONLY)
add_custom_command(OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/qrc_studio.cpp
    COMMAND Qt6::rcc --name studio --output ${CMAKE_CURRENT_BINARY_DIR}/qrc_studio.cpp ${CMAKE_CURRENT_BINARY_DIR}/studio.qrc
    DEPENDS ${CMAKE_CURRENT_BINARY_DIR}/studio.qrc ${icons} ${qms} VERBATIM)
target_sources(imomushi_studio PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/qrc_studio.cpp)
set_source_files_properties(${CMAKE_CURRENT_BINARY_DIR}/qrc_studio.cpp PROPERTIES SKIP_AUTOGEN ON)
