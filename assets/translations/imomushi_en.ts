<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="en" sourcelanguage="en">
    <context>
        <name>ToolTexts</name>
        <message numerus="yes">
            <source>%n thing(s)</source>
            <comment>that are selected</comment>
            <translation>
                <numerusform>%n thing</numerusform>
                <numerusform>%n things</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n cut(s)</source>
            <translation>
                <numerusform>%n cut</numerusform>
                <numerusform>%n cuts</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n bone(s)</source>
            <translation>
                <numerusform>%n bone</numerusform>
                <numerusform>%n bones</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n handle(s)</source>
            <translation>
                <numerusform>%n handle</numerusform>
                <numerusform>%n handles</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n pin(s)</source>
            <translation>
                <numerusform>%n pin</numerusform>
                <numerusform>%n pins</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n plane(s) that do not cut</source>
            <translation>
                <numerusform>%n plane that does not cut</numerusform>
                <numerusform>%n planes that do not cut</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>Click: joint face of %n vertices</source>
            <translation>
                <numerusform>Click: joint face of %n vertex</numerusform>
                <numerusform>Click: joint face of %n vertices</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::ImportDialog</name>
        <message numerus="yes">
            <source>The file holds no mesh, but %n clip(s) that can move “%1”.</source>
            <translation>
                <numerusform>The file holds no mesh, but %n clip that can move “%1”.</numerusform>
                <numerusform>The file holds no mesh, but %n clips that can move “%1”.</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n more</source>
            <translation>
                <numerusform>%n more</numerusform>
                <numerusform>%n more</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>Ready to import as %n element(s).</source>
            <translation>
                <numerusform>Ready to import as %n element.</numerusform>
                <numerusform>Ready to import as %n elements.</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n separate part(s)</source>
            <translation>
                <numerusform>%n separate part</numerusform>
                <numerusform>%n separate parts</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n cut(s)</source>
            <translation>
                <numerusform>%n cut</numerusform>
                <numerusform>%n cuts</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n bone(s)</source>
            <translation>
                <numerusform>%n bone</numerusform>
                <numerusform>%n bones</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n handle(s)</source>
            <translation>
                <numerusform>%n handle</numerusform>
                <numerusform>%n handles</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n pin(s)</source>
            <translation>
                <numerusform>%n pin</numerusform>
                <numerusform>%n pins</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n link(s) – change…</source>
            <translation>
                <numerusform>%n link – change…</numerusform>
                <numerusform>%n links – change…</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n chosen bone(s) cannot stay: no cut works there.</source>
            <translation>
                <numerusform>%n chosen bone cannot stay: no cut works there.</numerusform>
                <numerusform>%n chosen bones cannot stay: no cut works there.</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::BoneForm</name>
        <message numerus="yes">
            <source>%n bone(s)</source>
            <translation>
                <numerusform>%n bone</numerusform>
                <numerusform>%n bones</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::ElementForm</name>
        <message numerus="yes">
            <source>%n element(s)</source>
            <translation>
                <numerusform>%n element</numerusform>
                <numerusform>%n elements</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::PrecomputeFlow</name>
        <message numerus="yes">
            <source>Precompute cancelled; %n element(s) were done and are kept.</source>
            <translation>
                <numerusform>Precompute cancelled; %n element was done and is kept.</numerusform>
                <numerusform>Precompute cancelled; %n elements were done and are kept.</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::ExportDialog</name>
        <message numerus="yes">
            <source>%n target(s)</source>
            <translation>
                <numerusform>%n target</numerusform>
                <numerusform>%n targets</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>The %n most important of each element or character</source>
            <translation>
                <numerusform>The most important of each element or character</numerusform>
                <numerusform>The %n most important of each element or character</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::ExportReportView</name>
        <message numerus="yes">
            <source>Wrote %n file(s) from %1 on, %2</source>
            <translation>
                <numerusform>Wrote %n file from %1 on, %2</numerusform>
                <numerusform>Wrote %n files from %1 on, %2</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>Read back and compared in %n frame(s): off by %1 of the diagonal at most</source>
            <translation>
                <numerusform>Read back and compared in %n frame: off by %1 of the diagonal at most</numerusform>
                <numerusform>Read back and compared in %n frames: off by %1 of the diagonal at most</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::TakeModel</name>
        <message numerus="yes">
            <source>%1 s · %n frame(s)</source>
            <comment>length of a take</comment>
            <translation>
                <numerusform>%1 s · %n frame</numerusform>
                <numerusform>%1 s · %n frames</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>BodyTexts</name>
        <message numerus="yes">
            <source>%n link(s) of flesh, %1 % of the volume</source>
            <translation>
                <numerusform>%n link of flesh, %1 % of the volume</numerusform>
                <numerusform>%n links of flesh, %1 % of the volume</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n gap(s) closed, %1 % of the surface</source>
            <translation>
                <numerusform>%n gap closed, %1 % of the surface</numerusform>
                <numerusform>%n gaps closed, %1 % of the surface</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::WholeCharacterForm</name>
        <message numerus="yes">
            <source>%n more in the list of issues</source>
            <translation>
                <numerusform>%n more in the list of issues</numerusform>
                <numerusform>%n more in the list of issues</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::FileFlow</name>
        <message numerus="yes">
            <source>%n proposal(s) could not be made.</source>
            <translation>
                <numerusform>%n proposal could not be made.</numerusform>
                <numerusform>%n proposals could not be made.</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>“%1” has a skeleton of %n bone(s) now.</source>
            <translation>
                <numerusform>“%1” has a skeleton of %n bone now.</numerusform>
                <numerusform>“%1” has a skeleton of %n bones now.</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n clip(s) came along.</source>
            <translation>
                <numerusform>%n clip came along.</numerusform>
                <numerusform>%n clips came along.</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>“%1” has %n clip(s) more: make takes of them.</source>
            <translation>
                <numerusform>“%1” has %n clip more: make a take of it.</numerusform>
                <numerusform>“%1” has %n clips more: make takes of them.</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::RigFlow</name>
        <message numerus="yes">
            <source>Made %n take(s). The space bar plays the chosen one.</source>
            <translation>
                <numerusform>Made %n take. The space bar plays the chosen one.</numerusform>
                <numerusform>Made %n takes. The space bar plays the chosen one.</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::TakeDeck</name>
        <message numerus="yes">
            <source>%n element(s) play as drafts: precompute them (P) for what their settings ask for.</source>
            <translation>
                <numerusform>%n element plays as a draft: precompute it (P) for what its settings ask for.</numerusform>
                <numerusform>%n elements play as drafts: precompute them (P) for what their settings ask for.</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::RepairFlow</name>
        <message numerus="yes">
            <source>%n issue(s)</source>
            <translation>
                <numerusform>%n issue</numerusform>
                <numerusform>%n issues</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::MainWindow</name>
        <message numerus="yes">
            <source>%n mapping(s) made. Change them as you like.</source>
            <translation>
                <numerusform>%n mapping made. Change it as you like.</numerusform>
                <numerusform>%n mappings made. Change them as you like.</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n mapping(s) loaded.</source>
            <translation>
                <numerusform>%n mapping loaded.</numerusform>
                <numerusform>%n mappings loaded.</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n of them wait(s) for what the character does not have.</source>
            <translation>
                <numerusform>%n of them waits for what the character does not have.</numerusform>
                <numerusform>%n of them wait for what the character does not have.</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::SourceRows</name>
        <message numerus="yes">
            <source>%1 packets/s from %n sender(s).</source>
            <translation>
                <numerusform>%1 packets/s from %n sender.</numerusform>
                <numerusform>%1 packets/s from %n senders.</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::ClipboardFlow</name>
        <message numerus="yes">
            <source>Copied %n part(s)</source>
            <translation>
                <numerusform>Copied %n part</numerusform>
                <numerusform>Copied %n parts</numerusform>
            </translation>
        </message>
    </context>
</TS>
