<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="en" sourcelanguage="en">
    <context>
        <name>ToolTexts</name>
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
    </context>
    <context>
        <name>imomushi::InspectorPanel</name>
        <message numerus="yes">
            <source>%n element(s)</source>
            <translation>
                <numerusform>%n element</numerusform>
                <numerusform>%n elements</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n bone(s)</source>
            <translation>
                <numerusform>%n bone</numerusform>
                <numerusform>%n bones</numerusform>
            </translation>
        </message>
    </context>
</TS>
