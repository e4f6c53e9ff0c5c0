<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="ja" sourcelanguage="en">
    <context>
        <name>Actions</name>
        <message>
            <source>M&amp;ake it move by itself</source>
            <translation>ひとりでに動かす(&amp;A)</translation>
        </message>
        <message>
            <source>Sho&amp;w only what is selected</source>
            <translation>選択したものだけを表示(&amp;W)</translation>
        </message>
        <message>
            <source>Loc&amp;k or unlock what is selected</source>
            <translation>選択したものをロック／解除(&amp;K)</translation>
        </message>
        <message>
            <source>&amp;Versions…</source>
            <translation>バージョン(&amp;V)…</translation>
        </message>
        <message>
            <source>Start &amp;page</source>
            <translation>スタートページ(&amp;P)</translation>
        </message>
        <message>
            <source>&amp;New</source>
            <translation>新規(&amp;N)</translation>
        </message>
        <message>
            <source>&amp;Open…</source>
            <translation>開く(&amp;O)…</translation>
        </message>
        <message>
            <source>&amp;Import mesh…</source>
            <translation>メッシュを読み込む(&amp;I)…</translation>
        </message>
        <message>
            <source>&amp;Save</source>
            <translation>保存(&amp;S)</translation>
        </message>
        <message>
            <source>Save &amp;as…</source>
            <translation>名前を付けて保存(&amp;A)…</translation>
        </message>
        <message>
            <source>Save a &amp;copy…</source>
            <translation>コピーを保存(&amp;C)…</translation>
        </message>
        <message>
            <source>Save as scrip&amp;t…</source>
            <translation>スクリプトとして保存(&amp;T)…</translation>
        </message>
        <message>
            <source>&amp;Write posed mesh…</source>
            <translation>ポーズのメッシュを書き出す(&amp;W)…</translation>
        </message>
        <message>
            <source>&amp;Quit</source>
            <translation>終了(&amp;Q)</translation>
        </message>
        <message>
            <source>&amp;Undo</source>
            <translation>元に戻す(&amp;U)</translation>
        </message>
        <message>
            <source>&amp;Redo</source>
            <translation>やり直す(&amp;R)</translation>
        </message>
        <message>
            <source>&amp;Delete</source>
            <translation>削除(&amp;D)</translation>
        </message>
        <message>
            <source>Re&amp;name</source>
            <translation>名前を変更(&amp;N)</translation>
        </message>
        <message>
            <source>Select &amp;all of this kind</source>
            <translation>同じ種類をすべて選択(&amp;A)</translation>
        </message>
        <message>
            <source>Select n&amp;one</source>
            <translation>選択を解除(&amp;O)</translation>
        </message>
        <message>
            <source>Preferences…</source>
            <translation>設定…</translation>
        </message>
        <message>
            <source>&amp;Select</source>
            <translation>選択(&amp;S)</translation>
        </message>
        <message>
            <source>Joint &amp;face</source>
            <translation>関節面(&amp;F)</translation>
        </message>
        <message>
            <source>&amp;Bone</source>
            <translation>ボーン(&amp;B)</translation>
        </message>
        <message>
            <source>&amp;Drag</source>
            <translation>ドラッグ(&amp;D)</translation>
        </message>
        <message>
            <source>&amp;Precompute</source>
            <translation>前計算(&amp;P)</translation>
        </message>
        <message>
            <source>&amp;Join the selected joint faces</source>
            <translation>選択した関節面を結合(&amp;J)</translation>
        </message>
        <message>
            <source>P&amp;in or unpin</source>
            <translation>ピン留め／解除(&amp;I)</translation>
        </message>
        <message>
            <source>Release &amp;everything held</source>
            <translation>すべて放す(&amp;E)</translation>
        </message>
        <message>
            <source>Back to &amp;rest</source>
            <translation>静止姿勢に戻す(&amp;R)</translation>
        </message>
        <message>
            <source>&amp;Hide what is selected</source>
            <translation>選択したものを隠す(&amp;H)</translation>
        </message>
        <message>
            <source>&amp;Show everything</source>
            <translation>すべてを表示(&amp;S)</translation>
        </message>
        <message>
            <source>Frame &amp;all</source>
            <translation>全体を表示(&amp;A)</translation>
        </message>
        <message>
            <source>&amp;Frame the selection</source>
            <translation>選択範囲を表示(&amp;F)</translation>
        </message>
        <message>
            <source>Front</source>
            <translation>正面</translation>
        </message>
        <message>
            <source>Right</source>
            <translation>右</translation>
        </message>
        <message>
            <source>Top</source>
            <translation>上</translation>
        </message>
        <message>
            <source>&amp;Orthographic</source>
            <translation>平行投影(&amp;O)</translation>
        </message>
        <message>
            <source>Show &amp;bones</source>
            <translation>ボーンを表示(&amp;B)</translation>
        </message>
        <message>
            <source>Show &amp;ground</source>
            <translation>床を表示(&amp;G)</translation>
        </message>
        <message>
            <source>See th&amp;rough bodies</source>
            <translation>体を透かして見る(&amp;R)</translation>
        </message>
        <message>
            <source>F&amp;ull screen</source>
            <translation>全画面表示(&amp;U)</translation>
        </message>
        <message>
            <source>&amp;Dark</source>
            <translation>ダーク(&amp;D)</translation>
        </message>
        <message>
            <source>&amp;Light</source>
            <translation>ライト(&amp;L)</translation>
        </message>
        <message>
            <source>High &amp;contrast</source>
            <translation>ハイコントラスト(&amp;C)</translation>
        </message>
        <message>
            <source>Ma&amp;nual</source>
            <translation>マニュアル(&amp;N)</translation>
        </message>
        <message>
            <source>&amp;Mouse and keys</source>
            <translation>マウスとキー(&amp;M)</translation>
        </message>
        <message>
            <source>&amp;About Imomushi</source>
            <translation>Imomushi について(&amp;A)</translation>
        </message>
        <message>
            <source>&amp;Touch</source>
            <translation>タッチ(&amp;T)</translation>
        </message>
        <message>
            <source>&amp;Export…</source>
            <translation>書き出す(&amp;E)…</translation>
        </message>
        <message>
            <source>&amp;Record</source>
            <translation>記録(&amp;R)</translation>
        </message>
        <message>
            <source>&amp;Play</source>
            <translation>再生(&amp;P)</translation>
        </message>
        <message>
            <source>Frame &amp;back</source>
            <translation>前のフレーム(&amp;B)</translation>
        </message>
        <message>
            <source>Frame &amp;forward</source>
            <translation>次のフレーム(&amp;F)</translation>
        </message>
        <message>
            <source>&amp;Loop</source>
            <translation>くり返し(&amp;L)</translation>
        </message>
        <message>
            <source>Play fro&amp;m here</source>
            <translation>ここから再生(&amp;M)</translation>
        </message>
        <message>
            <source>Play &amp;until here</source>
            <translation>ここまで再生(&amp;U)</translation>
        </message>
        <message>
            <source>Play the &amp;whole take</source>
            <translation>テイク全体を再生(&amp;W)</translation>
        </message>
        <message>
            <source>&amp;Trim the take to its marks</source>
            <translation>テイクを目印で切り詰める(&amp;T)</translation>
        </message>
        <message>
            <source>Re&amp;name the take</source>
            <translation>テイクの名前を変える(&amp;N)</translation>
        </message>
        <message>
            <source>&amp;Duplicate the take</source>
            <translation>テイクを複製(&amp;D)</translation>
        </message>
        <message>
            <source>Remove the take</source>
            <translation>テイクを取り除く</translation>
        </message>
        <message>
            <source>Count three seconds before recording</source>
            <translation>3 秒数えてから記録</translation>
        </message>
        <message>
            <source>L&amp;eave the take</source>
            <translation>テイクを離れる(&amp;E)</translation>
        </message>
        <message>
            <source>&amp;Handle</source>
            <translation>ハンドル(&amp;H)</translation>
        </message>
        <message>
            <source>Show bo&amp;dies</source>
            <translation>ボディを表示(&amp;D)</translation>
        </message>
        <message>
            <source>Soft at &amp;once</source>
            <translation>すぐに柔らかく(&amp;O)</translation>
        </message>
        <message>
            <source>A&amp;dd a project…</source>
            <translation>プロジェクトを追加(&amp;D)…</translation>
        </message>
        <message>
            <source>Duplicate</source>
            <translation>複製</translation>
        </message>
        <message>
            <source>Mirror &amp;left and right (X)</source>
            <translation>左右にミラー (X)(&amp;L)</translation>
        </message>
        <message>
            <source>Mirror top and bottom (&amp;Y)</source>
            <translation>上下にミラー (&amp;Y)</translation>
        </message>
        <message>
            <source>Mirror &amp;front and back (Z)</source>
            <translation>前後にミラー (Z)(&amp;F)</translation>
        </message>
        <message>
            <source>Replace &amp;mesh…</source>
            <translation>メッシュを置き換え(&amp;M)…</translation>
        </message>
        <message>
            <source>Import s&amp;keleton…</source>
            <translation>骨格を読み込む(&amp;K)…</translation>
        </message>
        <message>
            <source>&amp;Make it soft</source>
            <translation>柔らかくする(&amp;M)</translation>
        </message>
        <message>
            <source>Make it soft by &amp;chosen bones…</source>
            <translation>ボーンを選んで柔らかくする(&amp;C)…</translation>
        </message>
        <message>
            <source>Make takes of clips…</source>
            <translation>クリップからテイクを作る…</translation>
        </message>
        <message>
            <source>Propose bones &amp;and cuts</source>
            <translation>ボーンと切断を提案(&amp;A)</translation>
        </message>
        <message>
            <source>Import c&amp;lips…</source>
            <translation>クリップを読み込む(&amp;L)…</translation>
        </message>
        <message>
            <source>Dra&amp;g the body anywhere</source>
            <translation>体のどこでもドラッグ(&amp;G)</translation>
        </message>
        <message>
            <source>Save a p&amp;icture…</source>
            <translation>画像を保存(&amp;I)…</translation>
        </message>
        <message>
            <source>&amp;Search…</source>
            <translation>検索(&amp;S)…</translation>
        </message>
        <message>
            <source>L&amp;ive inputs</source>
            <translation>ライブ入力(&amp;I)</translation>
        </message>
        <message>
            <source>Stop ever&amp;y input</source>
            <translation>全入力を止める(&amp;Y)</translation>
        </message>
        <message>
            <source>Load mappin&amp;gs…</source>
            <translation>対応づけを読み込む(&amp;G)…</translation>
        </message>
        <message>
            <source>Save mapping&amp;s…</source>
            <translation>対応づけを保存(&amp;S)…</translation>
        </message>
        <message>
            <source>Select what &amp;is not selected</source>
            <translation>選択を反転(&amp;I)</translation>
        </message>
        <message>
            <source>Select what is ne&amp;xt to it</source>
            <translation>隣のものも選択(&amp;X)</translation>
        </message>
        <message>
            <source>Select the chain of &amp;bones</source>
            <translation>ボーンの鎖を選択(&amp;B)</translation>
        </message>
        <message>
            <source>&amp;Keep the pose</source>
            <translation>ポーズを保存(&amp;K)</translation>
        </message>
        <message>
            <source>&amp;Mirror the pose</source>
            <translation>ポーズを左右反転(&amp;M)</translation>
        </message>
        <message>
            <source>Selected &amp;bones to rest</source>
            <translation>選択したボーンを静止姿勢へ(&amp;B)</translation>
        </message>
        <message>
            <source>&amp;Chains of the selected bones to rest</source>
            <translation>選択したボーンの鎖を静止姿勢へ(&amp;C)</translation>
        </message>
        <message>
            <source>Pose &amp;1</source>
            <translation>ポーズ &amp;1</translation>
        </message>
        <message>
            <source>Pose &amp;2</source>
            <translation>ポーズ &amp;2</translation>
        </message>
        <message>
            <source>Pose &amp;3</source>
            <translation>ポーズ &amp;3</translation>
        </message>
        <message>
            <source>Pose &amp;4</source>
            <translation>ポーズ &amp;4</translation>
        </message>
        <message>
            <source>Pose &amp;5</source>
            <translation>ポーズ &amp;5</translation>
        </message>
        <message>
            <source>Pose &amp;6</source>
            <translation>ポーズ &amp;6</translation>
        </message>
        <message>
            <source>Pose &amp;7</source>
            <translation>ポーズ &amp;7</translation>
        </message>
        <message>
            <source>Pose &amp;8</source>
            <translation>ポーズ &amp;8</translation>
        </message>
        <message>
            <source>Pose &amp;9</source>
            <translation>ポーズ &amp;9</translation>
        </message>
        <message>
            <source>&amp;Snap while dragging</source>
            <translation>ドラッグ中にスナップ(&amp;S)</translation>
        </message>
        <message>
            <source>Snap to the &amp;grid</source>
            <translation>格子にスナップ(&amp;G)</translation>
        </message>
        <message>
            <source>Snap &amp;angles</source>
            <translation>角度をスナップ(&amp;A)</translation>
        </message>
        <message>
            <source>Snap to &amp;vertices</source>
            <translation>頂点にスナップ(&amp;V)</translation>
        </message>
        <message>
            <source>Snap to the s&amp;urface</source>
            <translation>表面にスナップ(&amp;U)</translation>
        </message>
        <message>
            <source>Snap to the &amp;middle of bodies</source>
            <translation>体の肉の中心にスナップ(&amp;M)</translation>
        </message>
        <message>
            <source>Snap to ends of &amp;bones</source>
            <translation>ボーンの端にスナップ(&amp;B)</translation>
        </message>
        <message>
            <source>Steps to snap &amp;to…</source>
            <translation>スナップの刻み(&amp;T)…</translation>
        </message>
        <message>
            <source>Show the gi&amp;zmo</source>
            <translation>ギズモを表示(&amp;Z)</translation>
        </message>
        <message>
            <source>Axes of the &amp;world</source>
            <translation>ワールドの軸(&amp;W)</translation>
        </message>
        <message>
            <source>Axes of what is selecte&amp;d</source>
            <translation>選択したものの軸(&amp;D)</translation>
        </message>
        <message>
            <source>Axes of the &amp;view</source>
            <translation>ビューの軸(&amp;V)</translation>
        </message>
        <message>
            <source>Cu&amp;t</source>
            <translation>切り取り(&amp;T)</translation>
        </message>
        <message>
            <source>&amp;Copy</source>
            <translation>コピー(&amp;C)</translation>
        </message>
        <message>
            <source>&amp;Paste</source>
            <translation>貼り付け(&amp;P)</translation>
        </message>
        <message>
            <source>Left as right (&amp;X symmetry)</source>
            <translation>左右対称に編集 (&amp;X)</translation>
        </message>
        <message>
            <source>Place a &amp;bone…</source>
            <translation>ボーンを置く(&amp;B)…</translation>
        </message>
        <message>
            <source>Place a joint &amp;face…</source>
            <translation>関節面を置く(&amp;F)…</translation>
        </message>
        <message>
            <source>Place a &amp;cut…</source>
            <translation>切断面を置く(&amp;C)…</translation>
        </message>
        <message>
            <source>Place a &amp;handle…</source>
            <translation>ハンドルを置く(&amp;H)…</translation>
        </message>
        <message>
            <source>Map the &amp;keyboard</source>
            <translation>キーボードを対応づける(&amp;K)</translation>
        </message>
        <message>
            <source>Map a game &amp;controller</source>
            <translation>ゲームコントローラーを対応づける(&amp;C)</translation>
        </message>
        <message>
            <source>Map a body and a face by &amp;VMC</source>
            <translation>VMC で体と顔を対応づける(&amp;V)</translation>
        </message>
        <message>
            <source>Map a microp&amp;hone</source>
            <translation>マイクを対応づける(&amp;H)</translation>
        </message>
        <message>
            <source>Gizmo: a&amp;ll</source>
            <translation>ギズモ：すべて(&amp;L)</translation>
        </message>
        <message>
            <source>Gizmo: &amp;move</source>
            <translation>ギズモ：移動(&amp;M)</translation>
        </message>
        <message>
            <source>Gizmo: &amp;turn</source>
            <translation>ギズモ：回転(&amp;T)</translation>
        </message>
        <message>
            <source>Gizmo: &amp;scale</source>
            <translation>ギズモ：拡大縮小(&amp;S)</translation>
        </message>
        <message>
            <source>Snap to &amp;edges</source>
            <translation>辺にスナップ(&amp;E)</translation>
        </message>
        <message>
            <source>Stage: the character alo&amp;ne</source>
            <translation>ステージ：キャラクターだけを表示(&amp;N)</translation>
        </message>
        <message>
            <source>Move the &amp;joint face…</source>
            <translation>関節面を動かす(&amp;J)…</translation>
        </message>
    </context>
    <context>
        <name>EffectTexts</name>
        <message>
            <source>below %1 ms</source>
            <translation>%1 ms 未満</translation>
        </message>
        <message>
            <source>%1 ms</source>
            <translation>%1 ms</translation>
        </message>
    </context>
    <context>
        <name>MaterialPreset</name>
        <message>
            <source>Standard</source>
            <translation>標準</translation>
        </message>
        <message>
            <source>Jelly</source>
            <translation>ゼリー</translation>
        </message>
        <message>
            <source>Rubber</source>
            <translation>ゴム</translation>
        </message>
        <message>
            <source>Plush</source>
            <translation>ぬいぐるみ</translation>
        </message>
        <message>
            <source>Muscle</source>
            <translation>筋肉</translation>
        </message>
    </context>
    <context>
        <name>Effects</name>
        <message>
            <source>Bone dynamics</source>
            <translation>ボーンの揺れ</translation>
        </message>
        <message>
            <source>Bones swing, stretch and settle after each move.</source>
            <translation>動かしたあと、ボーンが揺れ、伸び縮みして落ち着きます。</translation>
        </message>
        <message>
            <source>Smooth joints</source>
            <translation>滑らかな関節</translation>
        </message>
        <message>
            <source>Joints take the shape of least energy: bends without a crease.</source>
            <translation>関節がエネルギー最小の形になり、折り目なく曲がります。</translation>
        </message>
        <message>
            <source>Bend warp</source>
            <translation>大変形の補正</translation>
        </message>
        <message>
            <source>Strong bends and twists keep their volume and do not fold.</source>
            <translation>強い曲げやねじりでも体積を保ち、折れ込みません。</translation>
        </message>
        <message>
            <source>Joint dynamics</source>
            <translation>関節の揺れ</translation>
        </message>
        <message>
            <source>Joints jiggle softly after each move.</source>
            <translation>動かしたあと、関節が柔らかく揺れます。</translation>
        </message>
        <message>
            <source>Previous model</source>
            <translation>従来モデル</translation>
        </message>
        <message>
            <source>Joint faces move by the explicit dynamics of the paper’s previous model. For comparison: it is slow and may diverge.</source>
            <translation>論文の従来モデルの陽解法で関節面を動かします。比較用です。遅く、発散することがあります。</translation>
        </message>
        <message>
            <source>Gravity and inertia</source>
            <translation>重力と慣性</translation>
        </message>
        <message>
            <source>Flesh sags under its weight and lags behind when it is moved.</source>
            <translation>重みで垂れ下がり、動かすと遅れてついてきます。</translation>
        </message>
        <message>
            <source>Stretching ends</source>
            <translation>先端の伸び</translation>
        </message>
        <message>
            <source>Flesh around the free end of a bone stretches with the bone, so that the end stays inside.</source>
            <translation>ボーンの自由端のまわりの肉がボーンと一緒に伸び縮みし、端が肉の外に出ません。</translation>
        </message>
        <message>
            <source>Inflate</source>
            <translation>膨らみ</translation>
        </message>
        <message>
            <source>Pressure inside puffs the body up, and lets it breathe.</source>
            <translation>内側の圧力で体を膨らませます。呼吸もできます。</translation>
        </message>
        <message>
            <source>Touch</source>
            <translation>タッチ</translation>
        </message>
        <message>
            <source>Fingers press dents into the surface (touch tool, T).</source>
            <translation>指で表面を押してへこませます（タッチツール、T）。</translation>
        </message>
        <message>
            <source>Contact</source>
            <translation>接触</translation>
        </message>
        <message>
            <source>Elements press dents into each other where they meet, instead of passing through. With the ground, into them, too.</source>
            <translation>要素が触れ合うところで、すり抜けずに互いを押してへこませます。床があれば床にも押されます。</translation>
        </message>
        <message>
            <source>On how many patches of a surface others press. More of them make finer dents, and a longer precompute.</source>
            <translation>表面のいくつの区画で押されるか。多いほどへこみが細かくなり、前計算が長くなります。</translation>
        </message>
        <message>
            <source>Coulomb’s coefficient between two surfaces. 0: they slide over each other.</source>
            <translation>表面どうしのクーロン摩擦係数。0 のときは互いに滑ります。</translation>
        </message>
        <message>
            <source>Ground</source>
            <translation>床</translation>
        </message>
        <message>
            <source>Bodies rest on a plane and do not sink through it.</source>
            <translation>体が平面の上にとどまり、下に沈みません。</translation>
        </message>
        <message>
            <source>Stretch</source>
            <translation>伸縮</translation>
        </message>
        <message>
            <source>How fast bones swing in their length.</source>
            <translation>ボーンが長さの方向に揺れる速さ。</translation>
        </message>
        <message>
            <source>Stretch damping</source>
            <translation>伸縮の減衰比</translation>
        </message>
        <message>
            <source>Damping ratio of the length. 0: it never stops; 1: no swing.</source>
            <translation>長さの減衰比。0：止まらない、1：揺れない。</translation>
        </message>
        <message>
            <source>Swing</source>
            <translation>曲げ</translation>
        </message>
        <message>
            <source>How fast the angles between bones swing.</source>
            <translation>ボーンの間の角度が揺れる速さ。</translation>
        </message>
        <message>
            <source>Swing damping</source>
            <translation>曲げの減衰比</translation>
        </message>
        <message>
            <source>Damping ratio of the angles. 0: they never stop; 1: no swing.</source>
            <translation>角度の減衰比。0：止まらない、1：揺れない。</translation>
        </message>
        <message>
            <source>Roll</source>
            <translation>ロール</translation>
        </message>
        <message>
            <source>How fast bones swing about themselves.</source>
            <translation>ボーンが自身の軸まわりに揺れる速さ。</translation>
        </message>
        <message>
            <source>Roll damping</source>
            <translation>ロールの減衰比</translation>
        </message>
        <message>
            <source>Damping ratio of the roll. 0: it never stops; 1: no swing.</source>
            <translation>ロールの減衰比。0：止まらない、1：揺れない。</translation>
        </message>
        <message>
            <source>Return</source>
            <translation>戻り</translation>
        </message>
        <message>
            <source>Air damping</source>
            <translation>空気の減衰</translation>
        </message>
        <message>
            <source>How fast every swing of a held character dies out, its slow sway as a whole too: half of it is left after 1.4 s over this.</source>
            <translation>保持されたキャラクターの揺れが、全身のゆっくりした揺れも含めて収まる速さです。1.4 秒をこの値で割った時間で半分になります。</translation>
        </message>
        <message>
            <source>How fast a character that nothing holds returns to its place. 0: not at all. With gravity and ground it falls, whatever this says.</source>
            <translation>何にも保持されていないキャラクターが元の位置に戻る速さ。0：戻らない。重力と床があるときは、この値によらず落ちます。</translation>
        </message>
        <message>
            <source>Jiggle</source>
            <translation>揺れ</translation>
        </message>
        <message>
            <source>How fast the softest part of a joint jiggles.</source>
            <translation>関節の最も柔らかい動きが揺れる速さ。</translation>
        </message>
        <message>
            <source>Damping</source>
            <translation>減衰</translation>
        </message>
        <message>
            <source>Damping ratio. 0: it never stops; 1: no jiggle.</source>
            <translation>減衰比。0：止まらない、1：揺れない。</translation>
        </message>
        <message>
            <source>Time step</source>
            <translation>時間刻み</translation>
        </message>
        <message>
            <source>Time step of the explicit integration. Longer ones diverge.</source>
            <translation>陽解法の時間刻み。長いと発散します。</translation>
        </message>
        <message>
            <source>Damping of the velocities of joint-face vertices.</source>
            <translation>関節面の頂点の速度の減衰。</translation>
        </message>
        <message>
            <source>Shear modulus</source>
            <translation>せん断弾性率</translation>
        </message>
        <message>
            <source>Shear modulus of elements with stiffness 1.</source>
            <translation>硬さ 1 の要素のせん断弾性率。</translation>
        </message>
        <message>
            <source>Gravity</source>
            <translation>重力</translation>
        </message>
        <message>
            <source>Acceleration of free fall, in the world.</source>
            <translation>自由落下の加速度（世界座標）。</translation>
        </message>
        <message>
            <source>Shear modulus of flesh of stiffness 1: less is softer, and sags more. It is used instead of “Sag”; 0: “Sag” is used.</source>
            <translation>硬さ 1 の肉のせん断弾性率。小さいほど柔らかく、大きく垂れます。「垂れ」の代わりに使われます。0：「垂れ」を使う。</translation>
        </message>
        <message>
            <source>Sag</source>
            <translation>垂れ</translation>
        </message>
        <message>
            <source>How far flesh of stiffness 1 sags under Earth’s gravity, as a share of the height of the character.</source>
            <translation>地球の重力で硬さ 1 の肉が垂れ下がる長さ（キャラクターの高さに対する割合）。</translation>
        </message>
        <message>
            <source>Inertia</source>
            <translation>慣性</translation>
        </message>
        <message>
            <source>How strongly the flesh lags behind when it is accelerated. 0: not at all.</source>
            <translation>加速したときに肉がどれだけ遅れてついてくるか。0：遅れない。</translation>
        </message>
        <message>
            <source>Pressure</source>
            <translation>圧力</translation>
        </message>
        <message>
            <source>Pressure over the shear modulus. Above 0 it puffs up, below it shrivels.</source>
            <translation>せん断弾性率に対する圧力。正で膨らみ、負でしぼみます。</translation>
        </message>
        <message>
            <source>Breath</source>
            <translation>呼吸の深さ</translation>
        </message>
        <message>
            <source>How much the pressure rises and falls with each breath. 0: none.</source>
            <translation>呼吸のたびに圧力が上下する大きさ。0：呼吸しない。</translation>
        </message>
        <message>
            <source>Breathing</source>
            <translation>呼吸の速さ</translation>
        </message>
        <message>
            <source>Breaths per second.</source>
            <translation>1 秒あたりの呼吸の回数。</translation>
        </message>
        <message>
            <source>Patches</source>
            <translation>パッチ数</translation>
        </message>
        <message>
            <source>How many patches of a surface fingers act on. More of them make finer dents, and a longer precompute.</source>
            <translation>指が働く表面のパッチの数。多いほどへこみが細かく、前計算が長くなります。</translation>
        </message>
        <message>
            <source>Friction</source>
            <translation>摩擦係数</translation>
        </message>
        <message>
            <source>Coulomb’s coefficient between a finger and the surface. 0: it only pushes straight in.</source>
            <translation>指と表面の間のクーロンの摩擦係数。0：まっすぐ押すだけ。</translation>
        </message>
        <message>
            <source>Finger tip</source>
            <translation>指先</translation>
        </message>
        <message>
            <source>Radius of finger tips, smooth spheres, which make fine dents at once. 0: only patches give way.</source>
            <translation>滑らかな球である指先の半径。細かいへこみがすぐにできます。0：パッチだけがへこみます。</translation>
        </message>
        <message>
            <source>Release</source>
            <translation>戻る時間</translation>
        </message>
        <message>
            <source>In this time a dent goes back after its finger lifts.</source>
            <translation>指を離したあと、へこみが戻るまでの時間。</translation>
        </message>
        <message>
            <source>Height</source>
            <translation>高さ</translation>
        </message>
        <message>
            <source>Height of the plane.</source>
            <translation>平面の高さ。</translation>
        </message>
        <message>
            <source>Coulomb’s coefficient between bodies and the ground, with bone dynamics.</source>
            <translation>体と床の間のクーロンの摩擦係数（「ボーンの揺れ」がオンのとき）。</translation>
        </message>
        <message>
            <source>A pose was not finite; the last good one stays. Go back to rest.</source>
            <translation>ポーズが有限の値になりませんでした。最後の正しいポーズを保ちます。静止姿勢に戻してください。</translation>
        </message>
        <message>
            <source>The previous model diverged: its joints stand still. Choose a smaller step or softer flesh.</source>
            <translation>従来モデルが発散しました。関節は止まっています。ステップを小さくするか、体を柔らかくしてください。</translation>
        </message>
        <message>
            <source>Gravity or pressure is too strong for flesh so soft: it acts less than asked for.</source>
            <translation>重力または圧力が、この柔らかさの体には強すぎます。指定より弱く働いています。</translation>
        </message>
        <message>
            <source>Flesh is pressed in more places than contact looks at: the deepest are held, others may cross.</source>
            <translation>接触で扱える数より多くの場所が押されています。深い場所から支え、ほかは貫通することがあります。</translation>
        </message>
        <message>
            <source>The ground keeps something held above its place.</source>
            <translation>床に支えられ、目標より上に留まっている所があります。</translation>
        </message>
        <message>
            <source>The target is out of reach: the bones stretch no farther.</source>
            <translation>目標に届きません。ボーンがこれ以上伸びません。</translation>
        </message>
        <message>
            <source>The pose twists a joint face, which the joint shapes “None, without twist” cannot follow: choose “None” or more.</source>
            <translation>関節面がねじれていますが、関節の形「なし（ねじれなし）」では表せません。「なし」かそれより多くを選んでください。</translation>
        </message>
    </context>
    <context>
        <name>Warnings</name>
        <message>
            <source>“%1” is not precomputed and follows its bones rigidly. Precompute it first.</source>
            <translation>「%1」は前計算されていないため、ボーンに剛体として追従します。先に前計算してください。</translation>
        </message>
        <message>
            <source>The character is not what it was when “%1” was recorded. Its poses are written without what effects added.</source>
            <translation>「%1」を記録した後にキャラクターが変わりました。エフェクトを除いたポーズだけを書き出しました。</translation>
        </message>
        <message>
            <source>The texture “%1” is neither PNG nor JPEG, which glTF needs, and was left out.</source>
            <translation>テクスチャ「%1」は glTF に必要な PNG でも JPEG でもないため、省かれました。</translation>
        </message>
        <message>
            <source>The frames of “%1” are not evenly spaced, which PC2 needs. Choose a frame rate.</source>
            <translation>「%1」のフレームは等間隔ではありません。PC2 には等間隔が必要です。フレームレートを選んでください。</translation>
        </message>
        <message>
            <source>“%1” goes out as a draft. Precompute it for what its settings ask for.</source>
            <translation>「%1」は下書きのまま書き出されます。設定どおりにするには前計算してください。</translation>
        </message>
    </context>
    <context>
        <name>Errors</name>
        <message>
            <source>This version of the project is not there, cannot be read or could not be kept.</source>
            <translation>プロジェクトのこのバージョンがないか、読めないか、残せませんでした。</translation>
        </message>
        <message>
            <source>There is no such command.</source>
            <translation>そのコマンドはありません。</translation>
        </message>
        <message>
            <source>The command does not know one of its keys.</source>
            <translation>コマンドに不明なキーがあります。</translation>
        </message>
        <message>
            <source>A key of the command is missing.</source>
            <translation>コマンドに必要なキーがありません。</translation>
        </message>
        <message>
            <source>A value has the wrong type.</source>
            <translation>値の型が正しくありません。</translation>
        </message>
        <message>
            <source>This value is not allowed here.</source>
            <translation>この値はここでは使えません。</translation>
        </message>
        <message>
            <source>Only finite numbers are accepted.</source>
            <translation>有限の数だけを指定できます。</translation>
        </message>
        <message>
            <source>There is no element of that name.</source>
            <translation>その名前の要素はありません。</translation>
        </message>
        <message>
            <source>There is no joint face of that name.</source>
            <translation>その名前の関節面はありません。</translation>
        </message>
        <message>
            <source>There is no bone of that name.</source>
            <translation>その名前のボーンはありません。</translation>
        </message>
        <message>
            <source>This name is already taken. Choose another one.</source>
            <translation>この名前はすでに使われています。別の名前にしてください。</translation>
        </message>
        <message>
            <source>This name cannot be used. Choose another one.</source>
            <translation>この名前は使えません。別の名前にしてください。</translation>
        </message>
        <message>
            <source>No flat patch of the surface lies there.</source>
            <translation>そこには平らな部分がありません。</translation>
        </message>
        <message>
            <source>A vertex does not exist.</source>
            <translation>存在しない頂点が指定されています。</translation>
        </message>
        <message>
            <source>The patch falls into several pieces. Choose one connected patch.</source>
            <translation>範囲がいくつかに分かれています。つながった範囲を選んでください。</translation>
        </message>
        <message>
            <source>The patch is too far from flat for a joint face.</source>
            <translation>関節面にするには平らではありません。</translation>
        </message>
        <message>
            <source>Another program uses this port. Close it, or choose another port here and in the sender.</source>
            <translation>ほかのプログラムがこのポートを使っています。そのプログラムを閉じるか、ここと送り手の両方で別のポートを選んでください。</translation>
        </message>
        <message>
            <source>This is no address. Give one such as 192.168.1.20; 127.0.0.1 is this machine.</source>
            <translation>アドレスではありません。192.168.1.20 のように指定してください。127.0.0.1 はこのコンピューターです。</translation>
        </message>
        <message>
            <source>Nothing can be sent there. Look at the address and at the network.</source>
            <translation>そこへは送れません。アドレスとネットワークを確認してください。</translation>
        </message>
        <message>
            <source>The port cannot be opened. Choose one from 1024 on.</source>
            <translation>ポートを開けません。1024 以上のポートを選んでください。</translation>
        </message>
        <message>
            <source>This file is no recording of live input.</source>
            <translation>このファイルはライブ入力の記録ではありません。</translation>
        </message>
        <message>
            <source>This recording of live input is too long. Record shorter parts.</source>
            <translation>このライブ入力の記録は長すぎます。短く分けて記録してください。</translation>
        </message>
        <message>
            <source>There is no such mapping.</source>
            <translation>その対応づけはありません。</translation>
        </message>
        <message>
            <source>This file holds no mappings of live input.</source>
            <translation>このファイルにはライブ入力の対応づけがありません。</translation>
        </message>
        <message>
            <source>There are too many mappings. Remove some first.</source>
            <translation>対応づけが多すぎます。先にいくつか削除してください。</translation>
        </message>
        <message>
            <source>The file was not found.</source>
            <translation>ファイルが見つかりません。</translation>
        </message>
        <message>
            <source>The file cannot be read. Check its permissions.</source>
            <translation>ファイルを読み込めません。アクセス権を確認してください。</translation>
        </message>
        <message>
            <source>The project cannot be saved, for it would not open again. Undo what was done last. Nothing was replaced.</source>
            <translation>保存しても開けなくなるため、プロジェクトを保存できません。最後の操作を取り消してください。何も置き換えていません。</translation>
        </message>
        <message>
            <source>There is no room on the disk. Make room or choose another one. Nothing was replaced.</source>
            <translation>ディスクに空きがありません。空きを作るか、別のディスクを選んでください。何も置き換えていません。</translation>
        </message>
        <message>
            <source>The file cannot be written. Check the folder and its permissions.</source>
            <translation>ファイルを書き込めません。フォルダーとアクセス権を確認してください。</translation>
        </message>
        <message>
            <source>This file format is not known. Use OBJ, PLY, STL, glTF, VRM, FBX or DAE.</source>
            <translation>このファイル形式には対応していません。OBJ、PLY、STL、glTF、VRM、FBX、DAE を使ってください。</translation>
        </message>
        <message>
            <source>The file is damaged and cannot be used.</source>
            <translation>ファイルが壊れているため使えません。</translation>
        </message>
        <message>
            <source>The mesh has vertices that are not finite numbers.</source>
            <translation>メッシュに有限でない座標の頂点があります。</translation>
        </message>
        <message>
            <source>There is no mesh in the file.</source>
            <translation>ファイルにメッシュがありません。</translation>
        </message>
        <message>
            <source>The mesh reaches farther than 1e9 m from the origin. Choose a smaller unit, or scale the mesh down in the program that made it.</source>
            <translation>メッシュが原点から 1e9 m より遠くまで達しています。小さい単位を選ぶか、作成したプログラムで縮小してください。</translation>
        </message>
        <message>
            <source>This is too large.</source>
            <translation>大きすぎます。</translation>
        </message>
        <message>
            <source>This took too long.</source>
            <translation>時間がかかりすぎました。</translation>
        </message>
        <message>
            <source>A helper process of the studio crashed. Repair the mesh, or export the file again.</source>
            <translation>スタジオの補助プロセスが異常終了しました。メッシュを修復するか、ファイルを書き出し直してください。</translation>
        </message>
        <message>
            <source>The system or another program ended a helper process of the studio. Try again.</source>
            <translation>スタジオの補助プロセスが、システムまたは別のプログラムに終了させられました。もう一度試してください。</translation>
        </message>
        <message>
            <source>Cancelled.</source>
            <translation>中止しました。</translation>
        </message>
        <message>
            <source>There is not enough memory. Use a smaller solver mesh.</source>
            <translation>メモリが足りません。計算用メッシュを小さくしてください。</translation>
        </message>
        <message>
            <source>It was done, but there was not enough memory for what follows it. Undo takes it back.</source>
            <translation>実行しましたが、その後の処理に必要なメモリが足りませんでした。「元に戻す」で取り消せます。</translation>
        </message>
        <message>
            <source>The element needs a joint face first.</source>
            <translation>要素には先に関節面が必要です。</translation>
        </message>
        <message>
            <source>Two joint faces of one element touch each other. Leave a row of vertices between them.</source>
            <translation>1 つの要素の 2 つの関節面が接しています。間に頂点の列を空けてください。</translation>
        </message>
        <message>
            <source>Nothing would be left of the joint face.</source>
            <translation>関節面に何も残りません。</translation>
        </message>
        <message>
            <source>Joint faces cover the whole element. Leave some of it free.</source>
            <translation>関節面が要素全体を覆っています。自由な部分を残してください。</translation>
        </message>
        <message>
            <source>The element cannot be solved. Check its mesh.</source>
            <translation>要素を計算できません。メッシュを確認してください。</translation>
        </message>
        <message>
            <source>The mesh is not a closed surface facing outward. Repair it first.</source>
            <translation>メッシュが外向きの閉じた面になっていません。先に修復してください。</translation>
        </message>
        <message>
            <source>The solution is not accurate enough. Check the mesh for slivers.</source>
            <translation>解の精度が足りません。細長い三角形がないか確認してください。</translation>
        </message>
        <message>
            <source>The project was made before the first release of Imomushi, and cannot be opened. Make it again from its meshes or scripts.</source>
            <translation>最初のリリースより前の Imomushi で作られたプロジェクトは開けません。メッシュまたはスクリプトから作り直してください。</translation>
        </message>
        <message>
            <source>The project was made by a newer version of Imomushi. Update to open it.</source>
            <translation>新しい版の Imomushi で作られたプロジェクトです。更新してから開いてください。</translation>
        </message>
        <message>
            <source>This file is not an Imomushi project.</source>
            <translation>このファイルは Imomushi のプロジェクトではありません。</translation>
        </message>
        <message>
            <source>There is nothing to undo.</source>
            <translation>元に戻す操作はありません。</translation>
        </message>
        <message>
            <source>There is nothing to redo.</source>
            <translation>やり直す操作はありません。</translation>
        </message>
        <message>
            <source>This session has been too long for one script: save the project, and the script begins there.</source>
            <translation>作業が長く、一つのスクリプトに収まりません。プロジェクトを保存すると、スクリプトはそこから始まります。</translation>
        </message>
        <message>
            <source>OpenGL 3.3 is not available on this machine.</source>
            <translation>この環境では OpenGL 3.3 を使えません。</translation>
        </message>
        <message>
            <source>There is no effect of that name.</source>
            <translation>その名前のエフェクトはありません。</translation>
        </message>
        <message>
            <source>The effect is not turned on.</source>
            <translation>そのエフェクトはオンになっていません。</translation>
        </message>
        <message>
            <source>This effect works on the whole character, not on a single element.</source>
            <translation>このエフェクトはキャラクター全体に働き、要素ごとには選べません。</translation>
        </message>
        <message>
            <source>There is no take of that name.</source>
            <translation>その名前のテイクはありません。</translation>
        </message>
        <message>
            <source>There is no character yet. Import an element first.</source>
            <translation>まだキャラクターがありません。先に要素を読み込んでください。</translation>
        </message>
        <message>
            <source>A take is being recorded. Stop that first.</source>
            <translation>テイクを記録中です。先に記録を止めてください。</translation>
        </message>
        <message>
            <source>Nothing is being recorded.</source>
            <translation>記録中のものはありません。</translation>
        </message>
        <message>
            <source>FBX is made by Blender, which was not found. Install it, or choose glTF.</source>
            <translation>FBX は Blender で作りますが、見つかりません。Blender を入れるか、glTF を選んでください。</translation>
        </message>
        <message>
            <source>Blender could not make the FBX file. Choose glTF instead.</source>
            <translation>Blender で FBX を作れませんでした。glTF を選んでください。</translation>
        </message>
        <message>
            <source>These joint faces are joined already.</source>
            <translation>これらの関節面はすでに結合されています。</translation>
        </message>
        <message>
            <source>This is no command.</source>
            <translation>これはコマンドではありません。</translation>
        </message>
        <message>
            <source>A picture is damaged or larger than 8192 pixels a side.</source>
            <translation>画像が壊れているか、一辺が 8192 ピクセルを超えています。</translation>
        </message>
        <message>
            <source>A line of the script cannot be read.</source>
            <translation>スクリプトに読めない行があります。</translation>
        </message>
        <message>
            <source>The parent of a bone must touch it, and cannot be one of its children. Choose another parent.</source>
            <translation>親にできるのは、そのボーンに接していて、その子ではないボーンだけです。別の親を選んでください。</translation>
        </message>
        <message>
            <source>A bone cannot end there. Choose another place.</source>
            <translation>そこをボーンの端にはできません。別の場所を選んでください。</translation>
        </message>
        <message>
            <source>The graphics driver refuses a shader. Update the driver.</source>
            <translation>グラフィックスドライバーがシェーダーを受け付けません。ドライバーを更新してください。</translation>
        </message>
        <message>
            <source>A picture of this size cannot be drawn.</source>
            <translation>この大きさの画像は描けません。</translation>
        </message>
        <message>
            <source>Bones form trees: this one would close a loop.</source>
            <translation>ボーンは木の形につながります。これでは輪になります。</translation>
        </message>
        <message>
            <source>The project is damaged. Open an earlier version of it.</source>
            <translation>プロジェクトが壊れています。以前の版を開いてください。</translation>
        </message>
        <message>
            <source>A key stands twice in one line of the script.</source>
            <translation>スクリプトの一行に同じキーが二度あります。</translation>
        </message>
        <message>
            <source>The joint faces are too far apart to be joined. Bring them together first.</source>
            <translation>関節面が離れすぎていて結合できません。先に近づけてください。</translation>
        </message>
        <message>
            <source>Something went wrong in the studio. What was done before is kept.</source>
            <translation>スタジオの内部で問題が起きました。それまでの作業は残っています。</translation>
        </message>
        <message>
            <source>A file that belongs to this one was not found.</source>
            <translation>付属するファイルが見つかりません。</translation>
        </message>
        <message>
            <source>There is no bone yet. Add one first.</source>
            <translation>ボーンがまだありません。先に追加してください。</translation>
        </message>
        <message>
            <source>Joint faces cover the whole surface. Make them smaller.</source>
            <translation>関節面が表面全体を覆っています。小さくしてください。</translation>
        </message>
        <message>
            <source>No bone reaches a part of the surface. Place bones there.</source>
            <translation>ボーンの届かない表面があります。そこにボーンを置いてください。</translation>
        </message>
        <message>
            <source>There is no such joint face or end of a bone.</source>
            <translation>そのような関節面やボーンの端はありません。</translation>
        </message>
        <message>
            <source>There is no such property.</source>
            <translation>そのような設定はありません。</translation>
        </message>
        <message>
            <source>There is no element, bone, joint face, handle, cut or effect of that name.</source>
            <translation>その名前の要素、ボーン、関節面、ハンドル、切断、エフェクトはありません。</translation>
        </message>
        <message>
            <source>This end of a bone or handle is not held.</source>
            <translation>このボーンの端やハンドルは保持されていません。</translation>
        </message>
        <message>
            <source>This joint face is not joined.</source>
            <translation>この関節面は結合されていません。</translation>
        </message>
        <message>
            <source>An element is not precomputed as it is now. Precompute it first.</source>
            <translation>今の状態で前計算されていない要素があります。先に前計算してください。</translation>
        </message>
        <message>
            <source>This end of a bone or handle is not pinned.</source>
            <translation>このボーンの端やハンドルはピン留めされていません。</translation>
        </message>
        <message>
            <source>The skin weights could not be computed. Repair triangles without area.</source>
            <translation>スキンウェイトを計算できませんでした。面積のない三角形を修復してください。</translation>
        </message>
        <message>
            <source>This point cannot be touched. Choose one of the free surface.</source>
            <translation>この点には触れません。関節面以外の表面を選んでください。</translation>
        </message>
        <message>
            <source>There is no finger at this point.</source>
            <translation>この点に指はありません。</translation>
        </message>
        <message>
            <source>The graphics driver has no memory for a picture of this size. Make it smaller.</source>
            <translation>この大きさの画像にはグラフィックスのメモリが足りません。小さくしてください。</translation>
        </message>
        <message>
            <source>A file that belongs to this one lies outside its folder.</source>
            <translation>付属するファイルがフォルダーの外にあります。</translation>
        </message>
        <message>
            <source>Both joint faces belong to one element. Choose faces of two elements.</source>
            <translation>2 つの関節面が同じ要素にあります。別々の要素の面を選んでください。</translation>
        </message>
        <message>
            <source>The body cannot be filled with tetrahedra. Repair it, or choose another solver mesh.</source>
            <translation>形状を四面体で満たせません。修復するか、別の計算用メッシュを選んでください。</translation>
        </message>
        <message>
            <source>The body meets itself. Repair it first, or choose another solver mesh.</source>
            <translation>形状が自分自身と交わっています。先に修復するか、別の計算用メッシュを選んでください。</translation>
        </message>
        <message>
            <source>The solver mesh cannot have so few vertices. Choose more.</source>
            <translation>計算用メッシュの頂点がこれほど少なくはできません。増やしてください。</translation>
        </message>
        <message>
            <source>There are too many fingers on this element. Lift one.</source>
            <translation>この要素に触れている指が多すぎます。一本離してください。</translation>
        </message>
        <message>
            <source>The solver mesh cannot have so many vertices. Choose fewer.</source>
            <translation>計算用メッシュの頂点がこれほど多くはできません。減らしてください。</translation>
        </message>
        <message>
            <source>There is no surface to cover. Import an element first.</source>
            <translation>覆う表面がありません。先に要素を読み込んでください。</translation>
        </message>
        <message>
            <source>The bone has no length. Let it end at another place.</source>
            <translation>ボーンに長さがありません。別の場所を端にしてください。</translation>
        </message>
        <message>
            <source>There is no handle of that name.</source>
            <translation>その名前のハンドルはありません。</translation>
        </message>
        <message>
            <source>The point is too far from the surface.</source>
            <translation>点が表面から離れすぎています。</translation>
        </message>
        <message>
            <source>A handle moves by itself and cannot be joined.</source>
            <translation>ハンドルは単独で動くため、結合できません。</translation>
        </message>
        <message>
            <source>The disc closes around a limb or has a hole. Make it smaller.</source>
            <translation>円板が手足を一周しているか、穴があります。小さくしてください。</translation>
        </message>
        <message>
            <source>The detail of a wrap must be between 0.001 and 0.2 times the diagonal of the mesh.</source>
            <translation>包み込みの細かさは、メッシュの対角線の 0.001 から 0.2 倍までです。</translation>
        </message>
        <message>
            <source>Cuts cannot change on which side of each other they lie. Put this one elsewhere.</source>
            <translation>切断面の並びは変えられません。ほかの場所に置いてください。</translation>
        </message>
        <message>
            <source>Two cuts touch, or are too close to each other. Move one of them away.</source>
            <translation>二つの切断面が触れているか、近すぎます。どちらかを離してください。</translation>
        </message>
        <message>
            <source>No skeleton was found, neither in the file nor in the shape. Cut by hand, or use handles.</source>
            <translation>ファイルにも形状にも骨格が見つかりません。手で切断するか、ハンドルを使ってください。</translation>
        </message>
        <message>
            <source>The character has cuts, bones or handles already. Take them out first.</source>
            <translation>キャラクターには切断、ボーン、またはハンドルが既にあります。先に取り除いてください。</translation>
        </message>
        <message>
            <source>The body still hangs together around the cut. Put it where it cuts something off.</source>
            <translation>切断面のまわりでボディがつながったままです。何かが切り離される場所に置いてください。</translation>
        </message>
        <message>
            <source>One side of the cut would have no volume. Move the plane deeper into the body.</source>
            <translation>切断面の片側に体積が残りません。平面をボディのもっと内側に動かしてください。</translation>
        </message>
        <message>
            <source>The cut would go through a joint face or touch it. Move the plane away, or remove the face first.</source>
            <translation>切断面が関節面を通るか、触れています。平面を離すか、先に面を削除してください。</translation>
        </message>
        <message>
            <source>The plane does not cross the body. Move it into the body.</source>
            <translation>平面がボディと交わっていません。ボディの中に動かしてください。</translation>
        </message>
        <message>
            <source>There is no character of that name.</source>
            <translation>その名前のキャラクターはありません。</translation>
        </message>
        <message>
            <source>There is no cut of that name.</source>
            <translation>その名前の切断面はありません。</translation>
        </message>
        <message>
            <source>No closed body with a volume can be made of this mesh. Give it thickness.</source>
            <translation>このメッシュからは体積のある閉じたボディを作れません。厚みを付けてください。</translation>
        </message>
        <message>
            <source>The mesh had to be mended to be a body. Choose “mended” or “auto”.</source>
            <translation>ボディにするには修復が必要なメッシュです。「修復」か「自動」を選んでください。</translation>
        </message>
        <message>
            <source>The mesh cannot be closed by mending. Choose a wrapped body.</source>
            <translation>このメッシュは修復では閉じられません。包み込みを選んでください。</translation>
        </message>
        <message>
            <source>The section nearest to the origin of the plane belongs to another element. Put the origin into the section that is meant.</source>
            <translation>平面の原点に最も近い断面は別の要素のものです。切りたい断面の中に原点を置いてください。</translation>
        </message>
        <message>
            <source>This element is a piece of a character. Choose the character, or take out the cut beside it.</source>
            <translation>この要素はキャラクターの一部です。キャラクターを選ぶか、隣の切断を取り除いてください。</translation>
        </message>
        <message>
            <source>The section touches or crosses itself. Move or turn the plane a little.</source>
            <translation>断面が自分自身に触れているか、交わっています。平面を少し動かすか、回してください。</translation>
        </message>
        <message>
            <source>The body changes where a joint face lies. Remove that face first.</source>
            <translation>ボディの変わるところに関節面があります。先にその面を削除してください。</translation>
        </message>
        <message>
            <source>The character has no part of that name.</source>
            <translation>その名前の部分はこのキャラクターにありません。</translation>
        </message>
        <message>
            <source>The part is not rigid by itself. Let it follow rigidly before you turn it.</source>
            <translation>この部分はそれだけでは剛体ではありません。回す前に剛体として従わせてください。</translation>
        </message>
        <message>
            <source>Nothing of the selection can be mirrored there.</source>
            <translation>選択したものは、そこではミラーできません。</translation>
        </message>
        <message>
            <source>It lies in the middle of the mirror plane.</source>
            <translation>ミラー面の中央にあります。</translation>
        </message>
        <message>
            <source>That cannot be done on both sides at once. Press X for one side.</source>
            <translation>両側を同時に変えることはできません。X で片側だけにできます。</translation>
        </message>
        <message>
            <source>The skin of the skeleton is for the vertices of the mesh before. Import the skeleton of the new file.</source>
            <translation>骨格のスキンは前のメッシュの頂点のものです。新しいファイルの骨格を読み込んでください。</translation>
        </message>
        <message>
            <source>It is its own mirror image.</source>
            <translation>それ自身が鏡像です。</translation>
        </message>
        <message>
            <source>Its mirror image is there already.</source>
            <translation>鏡像はすでにあります。</translation>
        </message>
        <message>
            <source>Not all of what it lies on has a mirror image.</source>
            <translation>載っているものの一部に鏡像がありません。</translation>
        </message>
        <message>
            <source>What it hangs on has no mirror image: it is a point of its own.</source>
            <translation>つながる相手に鏡像がないため、独立した点になります。</translation>
        </message>
        <message>
            <source>The new mesh is far larger or smaller than the old one. Choose its unit.</source>
            <translation>新しいメッシュの大きさが元と大きく違います。単位を選んでください。</translation>
        </message>
        <message>
            <source>The file holds several bodies. Choose one with a single body.</source>
            <translation>ファイルに複数のボディがあります。ボディが一つのファイルを選んでください。</translation>
        </message>
        <message>
            <source>The file holds no closed surface. Close its holes first.</source>
            <translation>ファイルに閉じた面がありません。先に穴を閉じてください。</translation>
        </message>
        <message>
            <source>The character has no such clip: import a file with animations.</source>
            <translation>キャラクターにそのクリップはありません。アニメーションのあるファイルを読み込んでください。</translation>
        </message>
        <message>
            <source>The take would not fit into memory: choose fewer frames per second.</source>
            <translation>テイクがメモリに収まりません。1 秒あたりのフレーム数を減らしてください。</translation>
        </message>
        <message>
            <source>The proposal contradicts itself. Give back the answer of propose, or correct what was changed.</source>
            <translation>提案が矛盾しています。propose の答えをそのまま返すか、変更した箇所を直してください。</translation>
        </message>
        <message>
            <source>That end of a bone lies on a cut. Move the cut.</source>
            <translation>ボーンのその端は切断の上にあります。切断を動かしてください。</translation>
        </message>
        <message>
            <source>A bone would have no length. Choose a place farther away.</source>
            <translation>ボーンの長さがなくなります。もっと離れた場所を選んでください。</translation>
        </message>
        <message>
            <source>This effect cannot turn on by itself where a pose needs it.</source>
            <translation>このエフェクトは、必要なポーズのときだけ自動でオンにすることができません。</translation>
        </message>
        <message>
            <source>The file is glTF 1. Export it again as glTF 2.0, or convert it with gltf-pipeline.</source>
            <translation>glTF 1 のファイルです。glTF 2.0 で書き出し直すか、gltf-pipeline で変換してください。</translation>
        </message>
        <message>
            <source>The file is FBX older than version 7. Export it as FBX 2011 or later, or convert it with Autodesk’s FBX Converter.</source>
            <translation>バージョン 7 より古い FBX です。FBX 2011 以降で書き出すか、Autodesk の FBX Converter で変換してください。</translation>
        </message>
        <message>
            <source>The file holds gaussian splats, which have no surface. Make a mesh of it in the program that it came from.</source>
            <translation>ファイルの中身はガウシアンスプラットで、面がありません。作成したソフトでメッシュにしてください。</translation>
        </message>
        <message>
            <source>A VRM file is one avatar with all humanoid bones. Begin with a VRM file, or export glTF.</source>
            <translation>VRM は人型ボーンがすべてそろったアバター 1 体のファイルです。VRM ファイルから始めるか、glTF で書き出してください。</translation>
        </message>
        <message>
            <source>No bone of the clips has a counterpart in the skeleton of the character.</source>
            <translation>クリップのボーンに対応するものが、キャラクターの骨格にありません。</translation>
        </message>
        <message>
            <source>Devices of this kind cannot be had on this machine: the system has no driver for them, or does not let this program have them.</source>
            <translation>このコンピューターでは、この種類の機器を使えません。システムにドライバーがないか、このプログラムに許していません。</translation>
        </message>
        <message>
            <source>There is no kept pose of that name.</source>
            <translation>その名前の保存したポーズはありません。</translation>
        </message>
        <message>
            <source>There are no bones and no handles yet: a pose is of them.</source>
            <translation>ボーンもハンドルもまだありません。ポーズはそれらから成ります。</translation>
        </message>
        <message>
            <source>There are too many kept poses. Remove some first.</source>
            <translation>保存したポーズが多すぎます。先にいくつか削除してください。</translation>
        </message>
        <message>
            <source>A kept pose is broken.</source>
            <translation>保存したポーズが壊れています。</translation>
        </message>
        <message>
            <source>There is no cycle of that name.</source>
            <translation>その名前のサイクルはありません。</translation>
        </message>
        <message>
            <source>A cycle goes through 2 to 64 kept poses. Choose as many.</source>
            <translation>サイクルは、保存したポーズ 2～64 個を通ります。その数だけ選んでください。</translation>
        </message>
        <message>
            <source>There are too many cycles. Remove some first.</source>
            <translation>サイクルが多すぎます。先にいくつか削除してください。</translation>
        </message>
        <message>
            <source>A cycle goes through this pose. Remove that cycle, or give it other poses, first.</source>
            <translation>このポーズを通るサイクルがあります。先にそのサイクルを削除するか、ほかのポーズに変えてください。</translation>
        </message>
        <message>
            <source>A cycle is broken.</source>
            <translation>サイクルが壊れています。</translation>
        </message>
        <message>
            <source>Nothing of this source is mapped. Map it first.</source>
            <translation>この送り手には対応づけがありません。先に対応づけてください。</translation>
        </message>
        <message>
            <source>This source is calibrated in three poses already. Clear one of them first.</source>
            <translation>この送り手は、すでに 3 つのポーズで合わせてあります。先に 1 つ消してください。</translation>
        </message>
        <message>
            <source>Nothing was heard that a pose could say something about. Let the source send, and measure again.</source>
            <translation>ポーズに関わるものが何も届きませんでした。送り手に送らせて、もう一度測ってください。</translation>
        </message>
        <message>
            <source>The source says the same as in another pose. Take this pose, hold it, and measure again.</source>
            <translation>送り手が、ほかのポーズのときと同じ値を送っています。このポーズをとって止まり、もう一度測ってください。</translation>
        </message>
        <message>
            <source>This source is not calibrated.</source>
            <translation>この送り手は合わせてありません。</translation>
        </message>
        <message>
            <source>A calibration is broken.</source>
            <translation>キャリブレーションが壊れています。</translation>
        </message>
        <message>
            <source>The character has nothing that could move by itself. Give it bones or handles first.</source>
            <translation>キャラクターには、ひとりでに動かせるものがありません。先にボーンかハンドルを付けてください。</translation>
        </message>
        <message>
            <source>Nothing of the selection can be copied.</source>
            <translation>選択したものはコピーできません。</translation>
        </message>
        <message>
            <source>Nothing that was copied can be pasted here.</source>
            <translation>コピーしたものは、ここには貼り付けられません。</translation>
        </message>
        <message>
            <source>What it hung on is not there: it is a point of its own.</source>
            <translation>つながっていた先がここにはないため、独立した点になりました。</translation>
        </message>
        <message>
            <source>There is nothing that could be driven so: the character needs bones whose ends are free, handles or shapes.</source>
            <translation>このようには何も動かせません。端が自由なボーン、ハンドル、形のどれかが必要です。</translation>
        </message>
        <message>
            <source>A joint face that is joined, of a cut or a handle has no plane of its own. Unjoin it, or move the cut or the handle.</source>
            <translation>つながった関節面、切断やハンドルの面は、単独では動かせません。つながりを外すか、切断やハンドルを動かしてください。</translation>
        </message>
    </context>
    <context>
        <name>Issues</name>
        <message>
            <source>Vertices at the same place were welded.</source>
            <translation>同じ位置の頂点を結合しました。</translation>
        </message>
        <message>
            <source>The surface has open edges. Close its holes.</source>
            <translation>面に開いた辺があります。穴を閉じてください。</translation>
        </message>
        <message>
            <source>More than two triangles meet at an edge.</source>
            <translation>1 つの辺に 3 枚以上の三角形が接しています。</translation>
        </message>
        <message>
            <source>Parts of the surface touch at a single vertex.</source>
            <translation>面の一部が 1 つの頂点だけで接しています。</translation>
        </message>
        <message>
            <source>Neighbouring triangles face different ways.</source>
            <translation>隣り合う三角形の向きがそろっていません。</translation>
        </message>
        <message>
            <source>Some triangles have no area.</source>
            <translation>面積のない三角形があります。</translation>
        </message>
        <message>
            <source>Some triangles exist twice.</source>
            <translation>重複した三角形があります。</translation>
        </message>
        <message>
            <source>The surface passes through itself.</source>
            <translation>面が自分自身と交差しています。</translation>
        </message>
        <message>
            <source>The mesh has several separate parts. Import them as one element each.</source>
            <translation>メッシュが複数の部分に分かれています。部分ごとに 1 つの要素として読み込んでください。</translation>
        </message>
        <message>
            <source>Some coordinates are not finite numbers.</source>
            <translation>有限でない座標があります。</translation>
        </message>
        <message>
            <source>Some vertices belong to no triangle.</source>
            <translation>どの三角形にも属さない頂点があります。</translation>
        </message>
        <message>
            <source>The mesh is very large. Check its unit.</source>
            <translation>メッシュが非常に大きいです。単位を確認してください。</translation>
        </message>
        <message>
            <source>The mesh is very small. Check its unit.</source>
            <translation>メッシュが非常に小さいです。単位を確認してください。</translation>
        </message>
        <message>
            <source>The mesh lies far from the origin.</source>
            <translation>メッシュが原点から遠く離れています。</translation>
        </message>
        <message>
            <source>Faces with more than three corners were split.</source>
            <translation>角が 4 つ以上の面を三角形に分けました。</translation>
        </message>
        <message>
            <source>Overlapping parts were united in the body.</source>
            <translation>重なっている部分をボディの中でまとめました。</translation>
        </message>
        <message>
            <source>Parts inside of others were left out of the body; the flesh around carries them.</source>
            <translation>ほかの部分の内側にある部分をボディから外しました。まわりの肉が運びます。</translation>
        </message>
        <message>
            <source>The body is not quite the mesh. Choose another way to make it, or repair the mesh.</source>
            <translation>ボディがメッシュと少し違います。ほかの作り方を選ぶか、メッシュを直してください。</translation>
        </message>
        <message>
            <source>The surface touched itself. The body has a little room there.</source>
            <translation>表面が自分と触れていました。ボディではそこに少しすき間をあけました。</translation>
        </message>
        <message>
            <source>The surface crosses itself. The body has other triangles there.</source>
            <translation>表面が自分と交わっています。ボディではそこを別の三角形にしました。</translation>
        </message>
        <message>
            <source>Parts that do not touch were linked by tubes of flesh.</source>
            <translation>触れ合わない部分を肉の管でつなぎました。</translation>
        </message>
        <message>
            <source>A link was not made: its two parts must face each other all around it, and touch nowhere else.</source>
            <translation>つなぎの一つを作れませんでした。二つの部分がその周り全体で向かい合い、ほかで触れていないことが必要です。</translation>
        </message>
        <message>
            <source>Parts without a motion of their own were left out of the body, which carries them.</source>
            <translation>自分では動かない部分をボディから外しました。ボディが運びます。</translation>
        </message>
        <message>
            <source>Open parts were left out of the body, which carries them.</source>
            <translation>開いた部分をボディから外しました。ボディが運びます。</translation>
        </message>
        <message>
            <source>Vertices lie at the same place and are not one.</source>
            <translation>同じ位置にある頂点がつながっていません。</translation>
        </message>
        <message>
            <source>The surface faces inward.</source>
            <translation>面が内側を向いています。</translation>
        </message>
        <message>
            <source>Walls inside of the flesh were left out of the body.</source>
            <translation>肉の内側の壁はボディから除きました。</translation>
        </message>
        <message>
            <source>A new surface around everything was made.</source>
            <translation>全体を包む新しい面を作りました。</translation>
        </message>
        <message>
            <source>The body closes gaps: what lies on their two sides moves as one.</source>
            <translation>ボディがすき間を閉じています。両側は一体で動きます。</translation>
        </message>
        <message>
            <source>Some steps failed or did not finish on this surface, and were skipped. Repair the mesh to get the whole body.</source>
            <translation>この面では一部の処理が失敗するか終わらないため、省きました。すべてを含むボディにするには、メッシュを直してください。</translation>
        </message>
        <message>
            <source>The body is extremely thin. Give it more thickness.</source>
            <translation>ボディが極端に薄いです。厚みを付けてください。</translation>
        </message>
        <message>
            <source>The surface has only one side.</source>
            <translation>面に表裏がありません。</translation>
        </message>
        <message>
            <source>Holes were closed.</source>
            <translation>穴を閉じました。</translation>
        </message>
        <message>
            <source>Surfaces that met in one edge were separated.</source>
            <translation>1 つの辺で接していた面を分けました。</translation>
        </message>
        <message>
            <source>Surfaces that touched in a vertex were separated.</source>
            <translation>頂点で接していた面を分けました。</translation>
        </message>
        <message>
            <source>A surface that faced inward was turned.</source>
            <translation>内側を向いていた面を裏返しました。</translation>
        </message>
        <message>
            <source>Triangles that faced against their neighbours were turned.</source>
            <translation>隣と逆を向いていた三角形を裏返しました。</translation>
        </message>
        <message>
            <source>Triangles without area were removed.</source>
            <translation>面積のない三角形を取り除きました。</translation>
        </message>
        <message>
            <source>Copies of triangles were removed.</source>
            <translation>重複した三角形を取り除きました。</translation>
        </message>
        <message>
            <source>Vertices of no triangle were left out.</source>
            <translation>どの三角形にも属さない頂点を除きました。</translation>
        </message>
        <message>
            <source>A VRM avatar: its humanoid bones, expressions and licence came along.</source>
            <translation>VRM アバター：人型ボーン、表情、ライセンスも読み込みました。</translation>
        </message>
        <message>
            <source>Springs, first person and look-at of the avatar are kept for export and move nothing here.</source>
            <translation>アバターの揺れもの、一人称表示、視線の設定は書き出し用に保たれます。ここでは何も動かしません。</translation>
        </message>
        <message>
            <source>Constraints between bones of the avatar have no effect here, and are not exported.</source>
            <translation>アバターのボーン間のコンストレイントは、ここでは働かず、書き出しもされません。</translation>
        </message>
        <message>
            <source>Of toon shading, colours and pictures were imported. Shade colours, rims and outlines are not shown, and not exported.</source>
            <translation>トゥーンシェーディングのうち、色と画像を読み込みました。陰の色、リム、輪郭線は表示されず、書き出しもされません。</translation>
        </message>
        <message>
            <source>Settings of the avatar for pictures, materials and things that were not imported were left out.</source>
            <translation>アバターの画像、マテリアル、読み込まれなかったものについての設定は省かれました。</translation>
        </message>
        <message>
            <source>Settings of the avatar that are wrong, or about things that do not exist, were left out.</source>
            <translation>アバターの設定のうち、誤りのあるものや存在しないものについてのものは省かれました。</translation>
        </message>
        <message>
            <source>Textures in KTX2 are not read and were left out. Export them as PNG or JPEG.</source>
            <translation>KTX2 のテクスチャは読み込めないため省かれました。PNG か JPEG で書き出してください。</translation>
        </message>
        <message>
            <source>Gaussian splats have no surface and were left out.</source>
            <translation>ガウシアンスプラットには面がないため省かれました。</translation>
        </message>
        <message>
            <source>The first animation moves nothing and was left out.</source>
            <translation>最初のアニメーションは何も動かさないため省かれました。</translation>
        </message>
        <message>
            <source>Clips also move lights, cameras or materials, which was left out.</source>
            <translation>クリップはライト、カメラ、マテリアルも動かしますが、その部分は省かれました。</translation>
        </message>
    </context>
    <context>
        <name>Stages</name>
        <message>
            <source>Reading</source>
            <translation>読み込み中</translation>
        </message>
        <message>
            <source>Welding</source>
            <translation>結合中</translation>
        </message>
        <message>
            <source>Mending</source>
            <translation>修復中</translation>
        </message>
        <message>
            <source>Checking</source>
            <translation>検査中</translation>
        </message>
        <message>
            <source>Estimating</source>
            <translation>見積もり中</translation>
        </message>
        <message>
            <source>Assembling</source>
            <translation>行列を組み立て中</translation>
        </message>
        <message>
            <source>Factorising</source>
            <translation>分解中</translation>
        </message>
        <message>
            <source>Solving</source>
            <translation>求解中</translation>
        </message>
        <message>
            <source>Reducing</source>
            <translation>縮約中</translation>
        </message>
        <message>
            <source>Preparing</source>
            <translation>準備中</translation>
        </message>
        <message>
            <source>Fitting</source>
            <translation>近似中</translation>
        </message>
        <message>
            <source>Writing</source>
            <translation>書き出し中</translation>
        </message>
        <message>
            <source>Saving</source>
            <translation>保存中</translation>
        </message>
        <message>
            <source>Converting</source>
            <translation>変換中</translation>
        </message>
        <message>
            <source>Looking for gaps</source>
            <translation>すき間を調べています</translation>
        </message>
        <message>
            <source>Wrapping</source>
            <translation>包んでいます</translation>
        </message>
        <message>
            <source>Coarsening</source>
            <translation>粗くしています</translation>
        </message>
        <message>
            <source>Cutting</source>
            <translation>切断しています</translation>
        </message>
        <message>
            <source>Looking for limbs</source>
            <translation>手足を探しています</translation>
        </message>
        <message>
            <source>Recording</source>
            <translation>記録中</translation>
        </message>
        <message>
            <source>Fitting clips</source>
            <translation>クリップを合わせています</translation>
        </message>
    </context>
    <context>
        <name>SelectionTexts</name>
        <message>
            <source>Mirrored, but for “%1”: %2</source>
            <translation>ミラーしました。ただし「%1」を除きます：%2</translation>
        </message>
        <message>
            <source>Mirrored, but for %1 parts. “%2”: %3</source>
            <translation>ミラーしました。ただし %1 個を除きます。「%2」：%3</translation>
        </message>
    </context>
    <context>
        <name>Steps</name>
        <message>
            <source>New project</source>
            <translation>新しいプロジェクト</translation>
        </message>
        <message>
            <source>Open project</source>
            <translation>プロジェクトを開く</translation>
        </message>
        <message>
            <source>Import element</source>
            <translation>要素の読み込み</translation>
        </message>
        <message>
            <source>Make soft</source>
            <translation>柔らかくする</translation>
        </message>
        <message>
            <source>Repair mesh</source>
            <translation>メッシュの修復</translation>
        </message>
        <message>
            <source>Cut element</source>
            <translation>要素の切断</translation>
        </message>
        <message>
            <source>Add joint face</source>
            <translation>関節面の追加</translation>
        </message>
        <message>
            <source>Join faces</source>
            <translation>面を結合</translation>
        </message>
        <message>
            <source>Separate faces</source>
            <translation>面を離す</translation>
        </message>
        <message>
            <source>Add bone</source>
            <translation>ボーンの追加</translation>
        </message>
        <message>
            <source>Change bone</source>
            <translation>ボーンの変更</translation>
        </message>
        <message>
            <source>Remove element</source>
            <translation>要素の削除</translation>
        </message>
        <message>
            <source>Remove joint face</source>
            <translation>関節面の削除</translation>
        </message>
        <message>
            <source>Remove bone</source>
            <translation>ボーンの削除</translation>
        </message>
        <message>
            <source>Rename</source>
            <translation>名前の変更</translation>
        </message>
        <message>
            <source>Pin</source>
            <translation>ピン留め</translation>
        </message>
        <message>
            <source>Unpin</source>
            <translation>ピンを外す</translation>
        </message>
        <message>
            <source>Change setting</source>
            <translation>設定の変更</translation>
        </message>
        <message>
            <source>Drag</source>
            <translation>ドラッグ</translation>
        </message>
        <message>
            <source>Release</source>
            <translation>放す</translation>
        </message>
        <message>
            <source>Rest pose</source>
            <translation>静止姿勢</translation>
        </message>
        <message>
            <source>Precompute</source>
            <translation>前計算</translation>
        </message>
        <message>
            <source>Turn on</source>
            <translation>オン</translation>
        </message>
        <message>
            <source>Turn off</source>
            <translation>オフ</translation>
        </message>
        <message>
            <source>Touch</source>
            <translation>タッチ</translation>
        </message>
        <message>
            <source>Record</source>
            <translation>記録</translation>
        </message>
        <message>
            <source>Rename take</source>
            <translation>テイク名の変更</translation>
        </message>
        <message>
            <source>Remove take</source>
            <translation>テイクの削除</translation>
        </message>
        <message>
            <source>Map input</source>
            <translation>入力の対応づけ</translation>
        </message>
        <message>
            <source>Remove mapping</source>
            <translation>対応づけの削除</translation>
        </message>
        <message>
            <source>Load mappings</source>
            <translation>対応づけの読み込み</translation>
        </message>
        <message>
            <source>Perform</source>
            <translation>演じる</translation>
        </message>
        <message>
            <source>Duplicate take</source>
            <translation>テイクの複製</translation>
        </message>
        <message>
            <source>Trim take</source>
            <translation>テイクの切り詰め</translation>
        </message>
        <message>
            <source>Add handle</source>
            <translation>ハンドルを追加</translation>
        </message>
        <message>
            <source>Remove handle</source>
            <translation>ハンドルを削除</translation>
        </message>
        <message>
            <source>Import character</source>
            <translation>キャラクターを読み込む</translation>
        </message>
        <message>
            <source>Import skeleton</source>
            <translation>骨格を読み込む</translation>
        </message>
        <message>
            <source>Move cut</source>
            <translation>切断面を動かす</translation>
        </message>
        <message>
            <source>Remove cut</source>
            <translation>切断面を取り除く</translation>
        </message>
        <message>
            <source>Attach part</source>
            <translation>部分の取り付け</translation>
        </message>
        <message>
            <source>Turn part</source>
            <translation>部分の回転</translation>
        </message>
        <message>
            <source>Set morph target</source>
            <translation>モーフターゲットの設定</translation>
        </message>
        <message>
            <source>Add project</source>
            <translation>プロジェクトを追加</translation>
        </message>
        <message>
            <source>Duplicate</source>
            <translation>複製</translation>
        </message>
        <message>
            <source>Mirror</source>
            <translation>ミラー</translation>
        </message>
        <message>
            <source>Move, turn or scale</source>
            <translation>移動、回転、拡大縮小</translation>
        </message>
        <message>
            <source>Replace mesh</source>
            <translation>メッシュを置き換え</translation>
        </message>
        <message>
            <source>Take of a clip</source>
            <translation>クリップのテイク</translation>
        </message>
        <message>
            <source>Import clips</source>
            <translation>クリップの読み込み</translation>
        </message>
        <message>
            <source>Show expression</source>
            <translation>表情の表示</translation>
        </message>
        <message>
            <source>Make character</source>
            <translation>キャラクターにする</translation>
        </message>
        <message>
            <source>Keep pose</source>
            <translation>ポーズを保存</translation>
        </message>
        <message>
            <source>Apply pose</source>
            <translation>ポーズを適用</translation>
        </message>
        <message>
            <source>Mirror the pose</source>
            <translation>ポーズを左右反転</translation>
        </message>
        <message>
            <source>Bones to rest</source>
            <translation>ボーンを静止姿勢へ</translation>
        </message>
        <message>
            <source>Rename pose</source>
            <translation>ポーズの名前を変更</translation>
        </message>
        <message>
            <source>Remove pose</source>
            <translation>ポーズを削除</translation>
        </message>
        <message>
            <source>Make cycle</source>
            <translation>サイクルを作成</translation>
        </message>
        <message>
            <source>Suggest cycles</source>
            <translation>サイクルを提案</translation>
        </message>
        <message>
            <source>Calibrate</source>
            <translation>送り手を合わせる</translation>
        </message>
        <message>
            <source>Clear calibration</source>
            <translation>キャリブレーションを消す</translation>
        </message>
        <message>
            <source>Rename cycle</source>
            <translation>サイクルの名前を変更</translation>
        </message>
        <message>
            <source>Remove cycle</source>
            <translation>サイクルを削除</translation>
        </message>
        <message>
            <source>Paste</source>
            <translation>貼り付け</translation>
        </message>
        <message>
            <source>Suggest mappings</source>
            <translation>対応づけの提案</translation>
        </message>
        <message>
            <source>Change joint face</source>
            <translation>関節面を変える</translation>
        </message>
    </context>
    <context>
        <name>Texts</name>
        <message>
            <source>%1: %2</source>
            <comment>undo step: what was done, to what</comment>
            <translation>%1：%2</translation>
        </message>
        <message>
            <source>%1 (%L2 places)</source>
            <comment>mesh issue, number of places</comment>
            <translation>%1（%L2 か所）</translation>
        </message>
        <message>
            <source>%1 ms</source>
            <translation>%1 ミリ秒</translation>
        </message>
        <message>
            <source>%1 s</source>
            <translation>%1 秒</translation>
        </message>
        <message>
            <source>%1 min %2 s</source>
            <translation>%1 分 %2 秒</translation>
        </message>
        <message>
            <source>%1 litres</source>
            <translation>%1 リットル</translation>
        </message>
    </context>
    <context>
        <name>ToolTexts</name>
        <message>
            <source>element “%1”</source>
            <translation>要素「%1」</translation>
        </message>
        <message>
            <source>handle “%1”</source>
            <translation>ハンドル「%1」</translation>
        </message>
        <message>
            <source>joint face “%1”</source>
            <translation>関節面「%1」</translation>
        </message>
        <message>
            <source>bone “%1”</source>
            <translation>ボーン「%1」</translation>
        </message>
        <message>
            <source>end of a bone “%1”</source>
            <translation>ボーンの端「%1」</translation>
        </message>
        <message>
            <source>character “%1”</source>
            <translation>キャラクター「%1」</translation>
        </message>
        <message>
            <source>cut “%1”</source>
            <translation>切断面「%1」</translation>
        </message>
        <message>
            <source>nothing</source>
            <comment>is selected or under the pointer</comment>
            <translation>なし</translation>
        </message>
        <message>
            <source>, </source>
            <comment>between names</comment>
            <translation>、</translation>
        </message>
        <message>
            <source>Selected: %1. Under the pointer: %2</source>
            <translation>選択中：%1。ポインターの下：%2</translation>
        </message>
        <message numerus="yes">
            <source>%n thing(s)</source>
            <comment>that are selected</comment>
            <translation>
                <numerusform>%n 個</numerusform>
            </translation>
        </message>
        <message>
            <source>A bone needs two different ends. Click somewhere else.</source>
            <translation>ボーンには異なる 2 つの端が必要です。別の場所をクリックしてください。</translation>
        </message>
        <message>
            <source>Import a mesh first</source>
            <translation>先にメッシュを読み込んでください</translation>
        </message>
        <message>
            <source>Click: end of the bone · Esc: end the chain</source>
            <translation>クリック：ボーンの終点 · Esc：連鎖を終える</translation>
        </message>
        <message>
            <source>Click: start of a bone (joint face, end of a bone, or inside a body)</source>
            <translation>クリック：ボーンの始点（関節面、ボーンの端、体の内部）</translation>
        </message>
        <message>
            <source>The faces were not joined. %1</source>
            <translation>面を結合できませんでした。%1</translation>
        </message>
        <message>
            <source>“%1” must be precomputed again then</source>
            <translation>「%1」は前計算をやり直すことになります</translation>
        </message>
        <message>
            <source>Release: keep · Esc: take back</source>
            <translation>離す：決定 · Esc：元に戻す</translation>
        </message>
        <message>
            <source>Drag: add to “%1” · Ctrl+drag: take away · Wheel: radius (%2) · C or Esc: put the brush away</source>
            <translation>ドラッグ：「%1」に加える · Ctrl+ドラッグ：取り除く · ホイール：半径（%2） · C か Esc：ブラシを終える</translation>
        </message>
        <message>
            <source>+ −: “%1” larger, smaller · C: brush · L: add what is flat here</source>
            <translation>+ −：「%1」を広く、狭く · C：ブラシ · L：ここの平らな部分を加える</translation>
        </message>
        <message>
            <source>Touches the joint face "%1"</source>
            <translation>関節面「%1」に接しています</translation>
        </message>
        <message>
            <source>↑ ↓: tolerance (%1) · Esc: cancel</source>
            <translation>↑ ↓：許容差 (%1) · Esc：取り消し</translation>
        </message>
        <message>
            <source>Enter or click: make the face · G, R: move, turn · X, Y, Z: axis · ↑ ↓: tolerance (%1) · Esc: cancel</source>
            <translation>Enter またはクリック：面を作る · G、R：移動、回転 · X、Y、Z：軸 · ↑ ↓：許容差（%1） · Esc：取り消し</translation>
        </message>
        <message>
            <source>Click: select the joint face "%1"</source>
            <translation>クリック：関節面「%1」を選択</translation>
        </message>
        <message numerus="yes">
            <source>Click: joint face of %n vertices</source>
            <translation>
                <numerusform>クリック：%n 頂点の関節面</numerusform>
            </translation>
        </message>
        <message>
            <source>↑ ↓: tolerance (%1) · Shift+click: plane</source>
            <translation>↑ ↓：許容差 (%1) · Shift+クリック：平面</translation>
        </message>
        <message>
            <source>Click a flat region: joint face · Shift+click: plane · Ctrl: look behind the surface</source>
            <translation>平らな部分をクリック：関節面 · Shift+クリック：平面 · Ctrl：奥の面を見る</translation>
        </message>
        <message>
            <source>X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · R or wheel: turn · Esc: cancel</source>
            <translation>X、Y、Z：軸を固定 · 数値を入力 · Shift：細かく · Ctrl：スナップ · R かホイール：ねじる · Esc：取り消し</translation>
        </message>
        <message>
            <source>There are no bones and no handles yet. Place them with their tools.</source>
            <translation>ボーンもハンドルもまだありません。それぞれのツールで置いてください。</translation>
        </message>
        <message>
            <source>Drag: pose · P: pin · Double click: let go</source>
            <translation>ドラッグ：ポーズ · P：ピン留め · ダブルクリック：放す</translation>
        </message>
        <message>
            <source>Turns about its pivot · Shift: fine · Wheel: about the line of sight · Esc: cancel</source>
            <translation>支点を中心に回ります · Shift：細かく · ホイール：視線のまわりに · Esc：取り消し</translation>
        </message>
        <message>
            <source>Drag: turn %1</source>
            <translation>ドラッグ：%1 を回す</translation>
        </message>
        <message>
            <source>Drag the end of a bone</source>
            <translation>ボーンの端をドラッグ</translation>
        </message>
        <message>
            <source>Click or drag a box: select · Ctrl+drag: lasso · Shift: add</source>
            <translation>クリックまたは範囲をドラッグ：選択 · Ctrl+ドラッグ：投げ縄 · Shift：追加</translation>
        </message>
        <message>
            <source>Click or drag a box: select · Ctrl+drag: lasso · Shift: add · Delete: remove</source>
            <translation>クリックまたは範囲をドラッグ：選択 · Ctrl+ドラッグ：投げ縄 · Shift：追加 · Delete：削除</translation>
        </message>
        <message>
            <source>Release: select what the box touches · Esc: cancel</source>
            <translation>離す：範囲に触れたものを選択 · Esc：取り消し</translation>
        </message>
        <message>
            <source>Click: select · Drag: pose</source>
            <translation>クリック：選択 · ドラッグ：ポーズ</translation>
        </message>
        <message>
            <source>Fingers need the effect “Touch”.</source>
            <translation>指で押すにはエフェクト「タッチ」が必要です。</translation>
        </message>
        <message>
            <source>The effect “Touch” is off on “%1”.</source>
            <translation>エフェクト「タッチ」は「%1」ではオフです。</translation>
        </message>
        <message>
            <source>Turn on</source>
            <translation>オンにする</translation>
        </message>
        <message>
            <source>Fingers need a precompute first, about %1.</source>
            <translation>指で押すには先に前計算が必要です（約 %1）。</translation>
        </message>
        <message>
            <source>Precompute</source>
            <translation>前計算</translation>
        </message>
        <message>
            <source>Move: push along · Wheel, Ctrl+drag or a typed number: depth · Shift: fine · Esc: take back</source>
            <translation>動かす：押しずらす · ホイール、Ctrl+ドラッグ、数値の入力：深さ · Shift：細かく · Esc：取り消し</translation>
        </message>
        <message>
            <source>The effect “Touch” is off. Click the surface to be asked about it</source>
            <translation>エフェクト「タッチ」はオフです。表面をクリックするとオンにできます</translation>
        </message>
        <message>
            <source>Press and hold, or G: poke a finger into the surface</source>
            <translation>押し続けるか G：指で表面をへこませる</translation>
        </message>
        <message>
            <source>Drag: pose · P: pin · Delete: remove the selected</source>
            <translation>ドラッグ：ポーズ · P：ピン留め · Delete：選択したものを削除</translation>
        </message>
        <message>
            <source>Press on a body: a handle, dragged at once</source>
            <translation>ボディを押す：ハンドルを作り、そのままドラッグ</translation>
        </message>
        <message>
            <source>Press: handle · Drag on: pose · [ ] or Ctrl+wheel: radius (%1)</source>
            <translation>押す：ハンドル · そのままドラッグ：ポーズ · [ ] か Ctrl+ホイール：半径 (%1)</translation>
        </message>
        <message>
            <source>Drag a handle or the end of a bone</source>
            <translation>ハンドルかボーンの端をドラッグ</translation>
        </message>
        <message>
            <source>Move it to the nearest place that works</source>
            <translation>切れる最も近い場所へ動かす</translation>
        </message>
        <message>
            <source>Drag the plane or G: move the cut · Drag its arrow: turn · Delete: remove</source>
            <translation>平面をドラッグか G：切断面を移動 · 矢印をドラッグ：向き · Delete：削除</translation>
        </message>
        <message>
            <source>Release: cut here · Type a number · Shift: fine · Ctrl: snap · X, Y, Z: turn · Esc: cancel</source>
            <translation>離す：ここで切る · 数値を入力 · Shift：細かく · Ctrl：スナップ · X、Y、Z：向き · Esc：取り消し</translation>
        </message>
        <message>
            <source>Esc: cancel</source>
            <translation>Esc：取り消し</translation>
        </message>
        <message>
            <source>The nearest place that works is %1 away.</source>
            <translation>切れる最も近い場所は %1 先です。</translation>
        </message>
        <message>
            <source>Cut there</source>
            <translation>そこで切る</translation>
        </message>
        <message>
            <source>Cut “%1” from “%2” and joined them.</source>
            <translation>「%1」を「%2」から切り離し、結合しました。</translation>
        </message>
        <message>
            <source>Enter or click: cut here · G, R: move, turn · X, Y, Z: axis · Esc: cancel</source>
            <translation>Enter またはクリック：ここで切断 · G、R：移動、回転 · X、Y、Z：軸 · Esc：取り消し</translation>
        </message>
        <message>
            <source>Click: cut across · Shift+click: plane · ↑: a patch of the surface instead</source>
            <translation>クリック：輪切りにする · Shift+クリック：平面 · ↑：代わりに表面の一部を面にする</translation>
        </message>
        <message>
            <source>No plane cuts the flesh here.</source>
            <translation>ここで肉を切断できる平面はありません。</translation>
        </message>
        <message>
            <source>“%1” does not cut there: %2</source>
            <comment>a plane, why</comment>
            <translation>「%1」はそこでは切断できません：%2</translation>
        </message>
        <message numerus="yes">
            <source>%n cut(s)</source>
            <translation>
                <numerusform>切断 %n</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n bone(s)</source>
            <translation>
                <numerusform>ボーン %n</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n handle(s)</source>
            <translation>
                <numerusform>ハンドル %n</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n pin(s)</source>
            <translation>
                <numerusform>ピン %n</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n plane(s) that do not cut</source>
            <translation>
                <numerusform>切断できない平面 %n</numerusform>
            </translation>
        </message>
        <message>
            <source>Mirror: on (X)</source>
            <translation>ミラー：オン (X)</translation>
        </message>
        <message>
            <source>Mirror: off (X)</source>
            <translation>ミラー：オフ (X)</translation>
        </message>
        <message>
            <source>Enter: make it soft</source>
            <translation>Enter：柔らかくする</translation>
        </message>
        <message>
            <source>Esc: leave it as it is</source>
            <translation>Esc：そのままにする</translation>
        </message>
        <message>
            <source>There is no flesh to cut here.</source>
            <translation>ここには切断する肉がありません。</translation>
        </message>
        <message>
            <source>It is being made soft …</source>
            <translation>柔らかくしています…</translation>
        </message>
        <message>
            <source>Release: leave it here · Shift: fine · Right button: take back</source>
            <translation>放す：ここに置く · Shift：微調整 · 右ボタン：元に戻す</translation>
        </message>
        <message>
            <source>Drag: move the plane · Ctrl+drag, or its arrow: turn it · Delete: drop it</source>
            <translation>ドラッグ：平面を移動 · Ctrl+ドラッグまたは矢印：回転 · Delete：取り除く</translation>
        </message>
        <message>
            <source>Drag: move the joint · Click: pin or unpin · Shift+drag: new bone</source>
            <translation>ドラッグ：関節点を移動 · クリック：ピンの切り替え · Shift+ドラッグ：新しいボーン</translation>
        </message>
        <message>
            <source>Delete: drop the bone</source>
            <translation>Delete：ボーンを取り除く</translation>
        </message>
        <message>
            <source>Drag: move the handle · Click: pin or unpin · Delete: drop it</source>
            <translation>ドラッグ：ハンドルを移動 · クリック：ピンの切り替え · Delete：取り除く</translation>
        </message>
        <message>
            <source>Click: add a cut · Shift+drag: add a bone · Drag planes and joints · Delete: drop</source>
            <translation>クリック：切断を追加 · Shift+ドラッグ：ボーンを追加 · 平面と関節点をドラッグ · Delete：取り除く</translation>
        </message>
        <message>
            <source>This handle stays · K: make it temporary · R or wheel: turn · Esc: cancel</source>
            <translation>このハンドルは残ります · K：一時的にする · R かホイール：回す · Esc：取り消し</translation>
        </message>
        <message>
            <source>Temporary handle · K: keep · X, Y, Z: lock axis · R or wheel: turn · Esc: cancel</source>
            <translation>一時ハンドル · K：残す · X、Y、Z：軸を固定 · R かホイール：回す · Esc：取り消し</translation>
        </message>
        <message>
            <source>K: bring the temporary handle back and keep it</source>
            <translation>K：一時ハンドルを戻して残す</translation>
        </message>
        <message>
            <source>Drag: pull the body here</source>
            <translation>ドラッグ：ここで体を引っぱる</translation>
        </message>
        <message>
            <source>Each finger leads what it holds · Esc: take back</source>
            <translation>どの指も、つかんだものを動かす · Esc：取り消し</translation>
        </message>
        <message>
            <source>X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · R or wheel: turn · B: the trunk leans, too · Esc: cancel</source>
            <translation>X、Y、Z：軸を固定 · 数値を入力 · Shift：細かく · Ctrl：スナップ · R かホイール：回す · B：胴も傾ける · Esc：取り消し</translation>
        </message>
        <message>
            <source>X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · R or wheel: turn · B: the trunk stays upright · Esc: cancel</source>
            <translation>X、Y、Z：軸を固定 · 数値を入力 · Shift：細かく · Ctrl：スナップ · R かホイール：回す · B：胴を起こしておく · Esc：取り消し</translation>
        </message>
        <message>
            <source>Stretched as far as it goes</source>
            <translation>これ以上は伸びません</translation>
        </message>
        <message>
            <source>Pressed together as far as it goes</source>
            <translation>これ以上は縮みません</translation>
        </message>
        <message>
            <source>Bent as far as it goes</source>
            <translation>これ以上は曲がりません</translation>
        </message>
        <message>
            <source>Out of reach</source>
            <translation>届きません</translation>
        </message>
        <message>
            <source>“%1” is held where it stands, so that handles bend it.</source>
            <translation>「%1」は立っている所で支えられています。ハンドルで曲げられます。</translation>
        </message>
        <message>
            <source>Let it go</source>
            <translation>支えを外す</translation>
        </message>
        <message>
            <source>The plane across %1 is seen from its edge: turn the view, or type numbers</source>
            <translation>%1 に垂直な平面が真横から見えています：視点を回すか、数値を入力してください</translation>
        </message>
        <message>
            <source>%1 is seen end on: turn the view, or type a number</source>
            <translation>%1 軸が正面を向いています：視点を回すか、数値を入力してください</translation>
        </message>
        <message>
            <source>Across %1</source>
            <translation>%1 に垂直な平面上</translation>
        </message>
        <message>
            <source>Along %1</source>
            <translation>%1 軸に沿う</translation>
        </message>
        <message>
            <source>Click or Enter: keep · G, R, S: move, turn, scale · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · Esc: cancel</source>
            <translation>クリックか Enter：確定 · G、R、S：移動、回転、拡大縮小 · X、Y、Z：軸を固定 · 数値を入力 · Shift：細かく · Ctrl：スナップ · Esc：取り消し</translation>
        </message>
        <message>
            <source>Release: the bone ends here · X, Y, Z: lock axis · Type a number · Ctrl: snap, and pass by joint faces · Esc: cancel</source>
            <translation>離す：端をここに置く · X、Y、Z：軸を固定 · 数値を入力 · Ctrl：スナップし、関節面に吸い付かない · Esc：取り消し</translation>
        </message>
        <message>
            <source>Click: start of a bone · Drag: move this end</source>
            <translation>クリック：ボーンの始点 · ドラッグ：この端を動かす</translation>
        </message>
        <message>
            <source>Click: start of a bone · G, R, S: move, turn, scale the selected bones</source>
            <translation>クリック：ボーンの始点 · G、R、S：選択したボーンを移動、回転、拡大縮小</translation>
        </message>
        <message>
            <source>Click or Enter: the handle goes here · S: radius · Ctrl: snap · Esc: cancel</source>
            <translation>クリックか Enter：ハンドルをここに置く · S：半径 · Ctrl：スナップ · Esc：取り消し</translation>
        </message>
        <message>
            <source>Click or Enter: keep the radius (%1) · Type a number · G: place · Ctrl: snap · Esc: cancel</source>
            <translation>クリックか Enter：この半径（%1）にする · 数値を入力 · G：位置 · Ctrl：スナップ · Esc：取り消し</translation>
        </message>
        <message>
            <source>Click or Enter: cut here · G, R: move, turn · Type a number · Shift: fine · Ctrl: snap · X, Y, Z: turn · Esc: cancel</source>
            <translation>クリックか Enter：ここで切る · G、R：移動、回転 · 数値を入力 · Shift：細かく · Ctrl：スナップ · X、Y、Z：向き · Esc：取り消し</translation>
        </message>
        <message>
            <source>Click or Enter: keep · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · R: turn · Esc: cancel</source>
            <translation>クリックか Enter：確定 · X、Y、Z：軸を固定 · 数値を入力 · Shift：細かく · Ctrl：スナップ · R：回す · Esc：取り消し</translation>
        </message>
        <message>
            <source>Drag the end of a bone or a handle · G: move the selected one</source>
            <translation>ボーンの端かハンドルをドラッグ · G：選択したものを動かす</translation>
        </message>
        <message>
            <source>On the grid</source>
            <translation>格子の上</translation>
        </message>
        <message>
            <source>To a vertex of %1</source>
            <translation>%1 の頂点へ</translation>
        </message>
        <message>
            <source>To the surface of %1</source>
            <translation>%1 の表面へ</translation>
        </message>
        <message>
            <source>To the middle of %1</source>
            <translation>%1 の肉の中心へ</translation>
        </message>
        <message>
            <source>To %1</source>
            <translation>%1 へ</translation>
        </message>
        <message>
            <source>Drag: move freely</source>
            <translation>ドラッグ：自由に動かす</translation>
        </message>
        <message>
            <source>Drag: turn about the view</source>
            <translation>ドラッグ：視線のまわりに回す</translation>
        </message>
        <message>
            <source>Drag: move along %1</source>
            <translation>ドラッグ：%1 に沿って動かす</translation>
        </message>
        <message>
            <source>Drag: move across %1</source>
            <translation>ドラッグ：%1 に垂直な面で動かす</translation>
        </message>
        <message>
            <source>Drag: turn about %1</source>
            <translation>ドラッグ：%1 のまわりに回す</translation>
        </message>
        <message>
            <source>Drag: scale along %1</source>
            <translation>ドラッグ：%1 に沿って拡大縮小</translation>
        </message>
        <message>
            <source>Drag: scale · Type a number · Shift: fine · Ctrl: snap · Esc: cancel</source>
            <translation>ドラッグ：拡大縮小 · 数値を入力 · Shift：細かく · Ctrl：スナップ · Esc：取り消し</translation>
        </message>
        <message>
            <source>What is scaled must be precomputed again</source>
            <translation>拡大縮小したものは前計算をやり直します</translation>
        </message>
        <message>
            <source>Its takes will show their poses alone</source>
            <translation>テイクはこれ以後ポーズだけを再生します</translation>
        </message>
        <message>
            <source>Results go along</source>
            <translation>計算結果も一緒に動きます</translation>
        </message>
        <message>
            <source>Click or drag a box: select · G, R, S: move, turn, scale · Delete: remove</source>
            <translation>クリックか囲むドラッグ：選択 · G、R、S：移動、回転、拡大縮小 · Delete：削除</translation>
        </message>
        <message>
            <source>Type a number · Shift: fine · Ctrl: snap · Esc: cancel</source>
            <translation>数値を入力 · Shift：細かく · Ctrl：スナップ · Esc：取り消し</translation>
        </message>
        <message>
            <source>Release: keep · X, Y, Z: lock axis · Type a number · Shift: fine · Ctrl: snap · Esc: cancel</source>
            <translation>離す：確定 · X、Y、Z：軸を固定 · 数値を入力 · Shift：細かく · Ctrl：スナップ · Esc：取り消し</translation>
        </message>
        <message>
            <source>“%1” has nothing on the other side: it moved alone.</source>
            <translation>「%1」は反対側に対応するものがないため、片側だけ動きました。</translation>
        </message>
        <message>
            <source>“%1” was not mirrored as a whole: %2</source>
            <translation>「%1」は完全にはミラーできませんでした：%2</translation>
        </message>
        <message>
            <source>Release: select what the loop touches · Esc: cancel</source>
            <translation>離す：囲みに触れたものを選択 · Esc：取り消し</translation>
        </message>
        <message>
            <source>Click or Enter: the plane stands so · Type an angle · G: move · Shift: fine · Ctrl: snap · Esc: back</source>
            <translation>クリックまたは Enter：この向きにする · 角度を入力 · G：移動 · Shift：細かく · Ctrl：スナップ · Esc：戻す</translation>
        </message>
        <message>
            <source>Click or Enter: the plane lies here · Type a number · R: turn · Shift: fine · Ctrl: snap · Esc: back</source>
            <translation>クリックまたは Enter：ここに置く · 数値を入力 · R：回転 · Shift：細かく · Ctrl：スナップ · Esc：戻す</translation>
        </message>
        <message>
            <source>Move: push along · Wheel, Ctrl or a typed number: depth · Shift: fine · Click or Enter: lift · Esc: take back</source>
            <translation>移動：押しながら動かす · ホイール、Ctrl、数値：深さ · Shift：細かく · クリックまたは Enter：離す · Esc：元に戻す</translation>
        </message>
        <message>
            <source>To an edge of %1</source>
            <translation>%1 の辺へ</translation>
        </message>
    </context>
    <context>
        <name>imomushi::Autosave</name>
        <message>
            <source>Your work could not be kept for recovery. %1</source>
            <translation>作業中の内容を復旧用に保存できませんでした。%1</translation>
        </message>
    </context>
    <context>
        <name>imomushi::BackgroundJob</name>
        <message>
            <source>%1 · %2 left</source>
            <comment>stage, time</comment>
            <translation>%1 · 残り %2</translation>
        </message>
    </context>
    <context>
        <name>imomushi::CalibrationBar</name>
        <message>
            <source>%1: nothing of it is mapped</source>
            <comment>a pose</comment>
            <translation>%1：対応づけがありません</translation>
        </message>
        <message>
            <source>%1: off by %2</source>
            <comment>a pose</comment>
            <translation>%1：ずれ %2</translation>
        </message>
        <message>
            <source>Forget what was measured in this pose</source>
            <translation>このポーズで測ったものを忘れる</translation>
        </message>
        <message>
            <source>Forget %1</source>
            <comment>a pose</comment>
            <translation>%1 を忘れる</translation>
        </message>
        <message>
            <source>Take the pose “%1” …</source>
            <translation>ポーズ「%1」をとってください …</translation>
        </message>
        <message>
            <source>Hold it …</source>
            <translation>そのまま …</translation>
        </message>
        <message>
            <source>Calibrate %1</source>
            <comment>a source</comment>
            <translation>%1 を合わせる</translation>
        </message>
        <message>
            <source>Stand as the character does in a pose, and hold still. One pose is met exactly; two or three that differ also tell how much.</source>
            <translation>キャラクターのポーズと同じように立ち、止まってください。1 つのポーズにはぴったり合います。違いのある 2 つか 3 つからは、動きの大きさもわかります。</translation>
        </message>
        <message>
            <source>Pose</source>
            <translation>ポーズ</translation>
        </message>
        <message>
            <source>Measure</source>
            <translation>測る</translation>
        </message>
        <message>
            <source>Counts down from three, and measures what the source says for half a second.</source>
            <translation>3 から数え、送り手が送るものを 0.5 秒間測ります。</translation>
        </message>
        <message>
            <source>Cancel</source>
            <translation>キャンセル</translation>
        </message>
        <message>
            <source>Close</source>
            <translation>閉じる</translation>
        </message>
    </context>
    <context>
        <name>imomushi::CommandSearch</name>
        <message>
            <source>Search</source>
            <translation>検索</translation>
        </message>
        <message>
            <source>Found</source>
            <translation>検索結果</translation>
        </message>
        <message>
            <source>Nothing is called “%1”. You can search for commands, panels, effects, settings and samples, and for the parts, takes and clips of this project.</source>
            <translation>「%1」は見つかりません。コマンド、パネル、エフェクト、設定、サンプル、このプロジェクトの部品・テイク・クリップを名前で探せます。</translation>
        </message>
    </context>
    <context>
        <name>imomushi::EffectsPanel</name>
        <message>
            <source>Effects</source>
            <translation>エフェクト</translation>
        </message>
        <message>
            <source>All effects</source>
            <translation>エフェクト全体</translation>
        </message>
        <message>
            <source>Processor time of one frame with all effects that are on, without drawing. At rest nothing is computed.</source>
            <translation>オンのエフェクトをすべて含む 1 フレームの処理時間（描画を除く）。静止中は何も計算しません。</translation>
        </message>
        <message>
            <source>Measured: per frame while it moves</source>
            <translation>実測：動いている間の 1 フレームあたり</translation>
        </message>
        <message>
            <source>about %1</source>
            <translation>約 %1</translation>
        </message>
        <message>
            <source>Predicted: per frame</source>
            <translation>予測：1 フレームあたり</translation>
        </message>
        <message>
            <source>Needs precompute, about %1</source>
            <translation>前計算が必要（約 %1）</translation>
        </message>
        <message>
            <source>%1 of %2</source>
            <translation>%1 / %2</translation>
        </message>
        <message>
            <source>at rest · %1</source>
            <translation>静止中 · %1</translation>
        </message>
        <message>
            <source>Works on</source>
            <translation>対象</translation>
        </message>
        <message>
            <source>All elements</source>
            <translation>すべての要素</translation>
        </message>
        <message>
            <source>All</source>
            <translation>すべて</translation>
        </message>
        <message>
            <source>This pose folds the surface.</source>
            <translation>このポーズでは表面が折れ込みます。</translation>
        </message>
        <message>
            <source>In this pose an element passes through its joint.</source>
            <translation>このポーズでは要素が関節を突き抜けます。</translation>
        </message>
        <message>
            <source>In this pose the volume is off by %1 %.</source>
            <translation>このポーズでは体積が %1 % ずれます。</translation>
        </message>
        <message>
            <source>This pose creases the surface at a joint.</source>
            <translation>このポーズでは関節のところに折り目がつきます。</translation>
        </message>
        <message>
            <source>Only where a pose calls for it</source>
            <translation>ポーズに必要なところだけ</translation>
        </message>
        <message>
            <source>Only on what comes near</source>
            <translation>近づいたものだけ</translation>
        </message>
        <message>
            <source>Elements are precomputed for it when they first come near others, and cost nothing before.</source>
            <translation>要素が初めてほかの要素に近づいたときに前計算されます。それまでは何も費やしません。</translation>
        </message>
        <message>
            <source>None yet</source>
            <translation>まだなし</translation>
        </message>
        <message>
            <source>No element has come near another one yet.</source>
            <translation>まだどの要素もほかの要素に近づいていません。</translation>
        </message>
        <message>
            <source>Turns on by itself, element by element, before anything folds. Until then it costs nothing.</source>
            <translation>折れ込む前に、要素ごとに自動でオンになります。それまでは計算しません。</translation>
        </message>
        <message>
            <source>Turn on</source>
            <translation>オンにする</translation>
        </message>
        <message>
            <source>Turns it on only where a pose calls for it.</source>
            <translation>ポーズに必要なところだけでオンにします。</translation>
        </message>
        <message>
            <source>Hold to compare</source>
            <translation>押している間比較</translation>
        </message>
        <message>
            <source>Shows the pose with the effect while you press.</source>
            <translation>押している間、エフェクトをかけたポーズを表示します。</translation>
        </message>
        <message>
            <source>Not now</source>
            <translation>今はしない</translation>
        </message>
        <message>
            <source>Frequencies and times</source>
            <translation>周波数と時間</translation>
        </message>
        <message>
            <source>shown</source>
            <translation>表示中</translation>
        </message>
        <message>
            <source>hidden</source>
            <translation>非表示</translation>
        </message>
        <message>
            <source>Copy the settings of “%1”</source>
            <translation>「%1」の設定をコピー</translation>
        </message>
        <message>
            <source>Copy the settings of all that are on</source>
            <translation>オンのエフェクトすべての設定をコピー</translation>
        </message>
        <message>
            <source>Paste settings</source>
            <translation>設定を貼り付け</translation>
        </message>
    </context>
    <context>
        <name>imomushi::Failures</name>
        <message>
            <source>There is not enough memory to do or draw this. Your work is safe. Close other programs, or choose a coarser solver mesh.</source>
            <translation>メモリが足りないため、実行または描画できませんでした。作業中の内容は失われていません。ほかのプログラムを終了するか、より粗い計算用メッシュを選んでください。</translation>
        </message>
        <message>
            <source>An error happened inside the program, and it gave up what it was doing: %1. Please report it.</source>
            <translation>プログラムの内部でエラーが起きたため、処理を中止しました：%1。ご報告ください。</translation>
        </message>
    </context>
    <context>
        <name>imomushi::FileFlow</name>
        <message>
            <source>, </source>
            <translation>、</translation>
        </message>
        <message>
            <source>A newer version of Imomushi wrote this project. Opened as a copy: saving it drops %1.</source>
            <translation>新しい版の Imomushi で作られたプロジェクトです。コピーとして開きました。保存すると次のものは失われます：%1</translation>
        </message>
        <message>
            <source>A newer version of Imomushi wrote this project. This version does not know the following; it keeps it, without effect: %1.</source>
            <translation>新しい版の Imomushi で作られたプロジェクトです。この版にない次のものは働きませんが、そのまま残ります：%1</translation>
        </message>
        <message>
            <source>Saved “%1”, but no version of it could be kept. %2</source>
            <translation>「%1」を保存しましたが、バージョンは残せませんでした。%2</translation>
        </message>
        <message>
            <source>Unsaved changes</source>
            <translation>未保存の変更</translation>
        </message>
        <message>
            <source>Save the changes of this new project?</source>
            <translation>この新しいプロジェクトの変更を保存しますか？</translation>
        </message>
        <message>
            <source>Save the changes of “%1”?</source>
            <translation>「%1」の変更を保存しますか？</translation>
        </message>
        <message>
            <source>If you don’t save them, they are lost.</source>
            <translation>保存しないと変更は失われます。</translation>
        </message>
        <message>
            <source>Save</source>
            <translation>保存</translation>
        </message>
        <message>
            <source>Don’t save</source>
            <translation>保存しない</translation>
        </message>
        <message>
            <source>Cancel</source>
            <translation>キャンセル</translation>
        </message>
        <message>
            <source>Open a project</source>
            <translation>プロジェクトを開く</translation>
        </message>
        <message>
            <source>Imomushi projects (*.imomushi)</source>
            <translation>Imomushi プロジェクト (*.imomushi)</translation>
        </message>
        <message>
            <source>Opening “%1”…</source>
            <translation>「%1」を開いています…</translation>
        </message>
        <message>
            <source>Saving “%1”…</source>
            <translation>「%1」を保存しています…</translation>
        </message>
        <message>
            <source>Saved “%1”</source>
            <translation>「%1」を保存しました</translation>
        </message>
        <message>
            <source>Character</source>
            <translation>キャラクター</translation>
        </message>
        <message>
            <source>Save the project as</source>
            <translation>プロジェクトに名前を付けて保存</translation>
        </message>
        <message>
            <source>Save a copy</source>
            <translation>コピーを保存</translation>
        </message>
        <message>
            <source>Saved a copy as “%1”</source>
            <translation>コピー「%1」を保存しました</translation>
        </message>
        <message>
            <source>Save this session as a script</source>
            <translation>この作業をスクリプトとして保存</translation>
        </message>
        <message>
            <source>Scripts (*.jsonl)</source>
            <translation>スクリプト (*.jsonl)</translation>
        </message>
        <message>
            <source>Write the posed mesh</source>
            <translation>ポーズのメッシュを書き出す</translation>
        </message>
        <message>
            <source>Meshes (*.obj *.ply)</source>
            <translation>メッシュ (*.obj *.ply)</translation>
        </message>
        <message>
            <source>Wrote “%1”</source>
            <translation>「%1」を書き出しました</translation>
        </message>
        <message>
            <source>Import meshes</source>
            <translation>メッシュを読み込む</translation>
        </message>
        <message>
            <source>Meshes (%1)</source>
            <translation>メッシュ (%1)</translation>
        </message>
        <message>
            <source>“%1” is neither a mesh nor a project.</source>
            <translation>「%1」はメッシュでもプロジェクトでもありません。</translation>
        </message>
        <message>
            <source>%1 copy</source>
            <translation>%1 のコピー</translation>
        </message>
        <message>
            <source>Imported “%1” as a whole character. Its body: %2.</source>
            <translation>「%1」をキャラクター全体として読み込みました。ボディ：%2。</translation>
        </message>
        <message>
            <source>“%1” is soft: drag it, or change its cuts and bones.</source>
            <translation>「%1」は柔らかくなりました。ドラッグするか、切断とボーンを変更できます。</translation>
        </message>
        <message numerus="yes">
            <source>%n proposal(s) could not be made.</source>
            <translation>
                <numerusform>%n 件の提案は実行できませんでした。</numerusform>
            </translation>
        </message>
        <message>
            <source>Add a project</source>
            <translation>プロジェクトを追加</translation>
        </message>
        <message>
            <source>Added “%1” to this project</source>
            <translation>「%1」をこのプロジェクトに追加しました</translation>
        </message>
        <message>
            <source>Replace the mesh</source>
            <translation>メッシュを置き換え</translation>
        </message>
        <message>
            <source>“%1” has its new mesh and kept its rig.</source>
            <translation>「%1」のメッシュを置き換えました。リグはそのままです。</translation>
        </message>
        <message>
            <source>%1 (%2)</source>
            <comment>what was lost, why</comment>
            <translation>%1 (%2)</translation>
        </message>
        <message numerus="yes">
            <source>%n more</source>
            <translation>
                <numerusform>ほか %n 個</numerusform>
            </translation>
        </message>
        <message>
            <source>“%1” has its new mesh. Lost: %2</source>
            <translation>「%1」のメッシュを置き換えました。失われたもの：%2</translation>
        </message>
        <message>
            <source>Dropped project</source>
            <translation>ドロップしたプロジェクト</translation>
        </message>
        <message>
            <source>Add “%1” to this project, or open it instead?</source>
            <translation>「%1」をこのプロジェクトに追加しますか、それとも開きますか？</translation>
        </message>
        <message>
            <source>Add</source>
            <translation>追加</translation>
        </message>
        <message>
            <source>Open</source>
            <translation>開く</translation>
        </message>
        <message>
            <source>From a rigged file</source>
            <translation>リグ付きファイルから</translation>
        </message>
        <message>
            <source>From a mesh</source>
            <translation>メッシュから</translation>
        </message>
        <message>
            <source>Making “%1” soft</source>
            <translation>「%1」を柔らかくしています</translation>
        </message>
        <message>
            <source>Import a skeleton</source>
            <translation>骨格を読み込む</translation>
        </message>
        <message>
            <source>Importing “%1”</source>
            <translation>「%1」を読み込んでいます</translation>
        </message>
        <message>
            <source>Importing the skeleton of “%1”</source>
            <translation>「%1」の骨格を読み込んでいます</translation>
        </message>
        <message numerus="yes">
            <source>“%1” has a skeleton of %n bone(s) now.</source>
            <translation>
                <numerusform>「%1」に %n 本のボーンの骨格が付きました。</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n clip(s) came along.</source>
            <translation>
                <numerusform>%n 個のクリップも読み込みました。</numerusform>
            </translation>
        </message>
        <message>
            <source>Import clips</source>
            <translation>クリップを読み込む</translation>
        </message>
        <message>
            <source>Importing the clips of “%1”</source>
            <translation>「%1」のクリップを読み込んでいます</translation>
        </message>
        <message numerus="yes">
            <source>“%1” has %n clip(s) more: make takes of them.</source>
            <translation>
                <numerusform>「%1」にクリップが %n 個加わりました。テイクにできます。</numerusform>
            </translation>
        </message>
        <message>
            <source>These bones of the clips have no counterpart in it: %1</source>
            <translation>クリップの次のボーンに対応するものがありません：%1</translation>
        </message>
    </context>
    <context>
        <name>imomushi::HistoryModel</name>
        <message>
            <source>Beginning</source>
            <translation>はじめ</translation>
        </message>
    </context>
    <context>
        <name>imomushi::HistoryPanel</name>
        <message>
            <source>History</source>
            <translation>履歴</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ImportDialog</name>
        <message>
            <source>The file holds bones, but neither a mesh nor clips.</source>
            <translation>このファイルにはボーンがありますが、メッシュもクリップもありません。</translation>
        </message>
        <message numerus="yes">
            <source>The file holds no mesh, but %n clip(s) that can move “%1”.</source>
            <translation>
                <numerusform>このファイルにメッシュはありませんが、「%1」を動かせるクリップが %n 個あります。</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n more</source>
            <translation>
                <numerusform>ほか %n 個</numerusform>
            </translation>
        </message>
        <message>
            <source>Import clips</source>
            <translation>クリップを読み込む</translation>
        </message>
        <message>
            <source>Import %1</source>
            <translation>%1 の読み込み</translation>
        </message>
        <message>
            <source>As in the file</source>
            <translation>ファイルのまま</translation>
        </message>
        <message>
            <source>Millimetres</source>
            <translation>ミリメートル</translation>
        </message>
        <message>
            <source>Centimetres</source>
            <translation>センチメートル</translation>
        </message>
        <message>
            <source>Metres</source>
            <translation>メートル</translation>
        </message>
        <message>
            <source>Y is up</source>
            <translation>Y が上</translation>
        </message>
        <message>
            <source>Z is up</source>
            <translation>Z が上</translation>
        </message>
        <message>
            <source>One element per separate part</source>
            <translation>離れた部分ごとに 1 つの要素にする</translation>
        </message>
        <message>
            <source>Unit</source>
            <translation>単位</translation>
        </message>
        <message>
            <source>Up axis</source>
            <translation>上の軸</translation>
        </message>
        <message>
            <source>Import</source>
            <translation>読み込む</translation>
        </message>
        <message>
            <source>Reading</source>
            <translation>読み込み中</translation>
        </message>
        <message>
            <source>%1 of %2 bodies can be used; the others are left out.</source>
            <translation>%2 個のうち %1 個を使えます。残りは除かれます。</translation>
        </message>
        <message>
            <source>Ready to import.</source>
            <translation>読み込めます。</translation>
        </message>
        <message numerus="yes">
            <source>Ready to import as %n element(s).</source>
            <translation>
                <numerusform>%n 個の要素として読み込めます。</numerusform>
            </translation>
        </message>
        <message>
            <source>Size  %1 × %2 × %3</source>
            <translation>大きさ  %1 × %2 × %3</translation>
        </message>
        <message>
            <source>%1 vertices, %2 triangles</source>
            <translation>頂点 %1、三角形 %2</translation>
        </message>
        <message numerus="yes">
            <source>%n separate part(s)</source>
            <translation>
                <numerusform>離れた部分 %n 個</numerusform>
            </translation>
        </message>
        <message>
            <source>Whole character</source>
            <translation>キャラクター全体</translation>
        </message>
        <message>
            <source>Any mesh. It keeps its look; a body moves it.</source>
            <translation>どんなメッシュも可。見た目はそのまま、ボディが動かします。</translation>
        </message>
        <message>
            <source>Elements</source>
            <translation>要素</translation>
        </message>
        <message>
            <source>Closed surfaces. Each one becomes a soft element.</source>
            <translation>閉じた面。それぞれが柔らかい要素になります。</translation>
        </message>
        <message>
            <source>Body</source>
            <translation>ボディ</translation>
        </message>
        <message>
            <source>Automatic</source>
            <translation>自動</translation>
        </message>
        <message>
            <source>Exact: the mesh itself</source>
            <translation>そのまま：メッシュ自身</translation>
        </message>
        <message>
            <source>Mended: holes closed, parts united</source>
            <translation>修復：穴を閉じ、部分をまとめる</translation>
        </message>
        <message>
            <source>Wrapped: a new surface around it</source>
            <translation>包み直し：まわりに新しい面を張る</translation>
        </message>
        <message>
            <source>Detail of a wrap</source>
            <translation>包む細かさ</translation>
        </message>
        <message>
            <source>Coarse</source>
            <translation>粗い</translation>
        </message>
        <message>
            <source>Medium</source>
            <translation>普通</translation>
        </message>
        <message>
            <source>Fine</source>
            <translation>細かい</translation>
        </message>
        <message>
            <source>Very fine</source>
            <translation>とても細かい</translation>
        </message>
        <message>
            <source>Closes gaps narrower than twice this share of the diagonal: 1/30, 1/60, 1/120, 1/250.</source>
            <translation>対角線に対するこの割合（1/30、1/60、1/120、1/250）の 2 倍より狭いすき間は閉じられます。</translation>
        </message>
        <message>
            <source>The body is being made…</source>
            <translation>ボディを作っています…</translation>
        </message>
        <message>
            <source>This mesh cannot be used as an element: it is not a closed surface. Import it as a whole character.</source>
            <translation>このメッシュは閉じた面ではないため、要素にはできません。キャラクター全体として読み込んでください。</translation>
        </message>
        <message>
            <source>Ready to import. The body is %1.</source>
            <translation>読み込めます。ボディ：%1。</translation>
        </message>
        <message>
            <source>Unmended: repair it issue by issue</source>
            <translation>未修復：問題を一つずつ修復</translation>
        </message>
        <message>
            <source>Make it soft: cuts and bones as its shape suggests</source>
            <translation>柔らかくする：切断とボーンを形から決める</translation>
        </message>
        <message>
            <source>Follows the skeleton of the file, if it has one, else the shape. You can change everything afterwards, or undo it in one step.</source>
            <translation>ファイルに骨格があればそれから、なければ形から決めます。後ですべて変更でき、1 回の取り消しで元に戻せます。</translation>
        </message>
        <message numerus="yes">
            <source>%n cut(s)</source>
            <translation>
                <numerusform>切断 %n</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n bone(s)</source>
            <translation>
                <numerusform>ボーン %n</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n handle(s)</source>
            <translation>
                <numerusform>ハンドル %n</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n pin(s)</source>
            <translation>
                <numerusform>ピン %n</numerusform>
            </translation>
        </message>
        <message>
            <source>Proposed from its skeleton: %1</source>
            <translation>骨格からの提案：%1</translation>
        </message>
        <message>
            <source>Proposed from its shape: %1</source>
            <translation>形からの提案：%1</translation>
        </message>
        <message>
            <source>Replace the mesh of %1</source>
            <translation>%1 のメッシュを置き換え</translation>
        </message>
        <message>
            <source>Replace</source>
            <translation>置き換え</translation>
        </message>
        <message>
            <source>Ready to replace the mesh.</source>
            <translation>メッシュを置き換えられます。</translation>
        </message>
        <message>
            <source>Ready to replace the mesh. The body is %1.</source>
            <translation>メッシュを置き換えられます。ボディ：%1。</translation>
        </message>
        <message>
            <source>Skeleton</source>
            <translation>骨格</translation>
        </message>
        <message>
            <source>Bones of the skeleton that stay</source>
            <translation>残すボーン</translation>
        </message>
        <message>
            <source>Keep this size</source>
            <translation>この大きさのまま</translation>
        </message>
        <message>
            <source>Import and make soft</source>
            <translation>読み込んで柔らかくする</translation>
        </message>
        <message>
            <source>Flesh</source>
            <translation>肉</translation>
        </message>
        <message>
            <source>Links of flesh between parts that do not touch</source>
            <translation>触れていない部分のあいだの肉のつなぎ</translation>
        </message>
        <message numerus="yes">
            <source>%n link(s) – change…</source>
            <translation>
                <numerusform>つなぎ %n 個 – 変える…</numerusform>
            </translation>
        </message>
        <message>
            <source>%1 of %2 bones stay – choose…</source>
            <translation>%2 本中 %1 本を残す – 選ぶ…</translation>
        </message>
        <message numerus="yes">
            <source>%n chosen bone(s) cannot stay: no cut works there.</source>
            <translation>
                <numerusform>選んだボーンのうち %n 本は残せません。そこでは切断できません。</numerusform>
            </translation>
        </message>
        <message>
            <source>The file holds no skeleton: cuts and bones follow the shape.</source>
            <translation>このファイルには骨格がありません。切断とボーンは形から決めます。</translation>
        </message>
        <message>
            <source>It is %1 large. Is that the right unit? In centimetres it is %2.</source>
            <translation>大きさが %1 あります。単位は正しいですか。センチメートルなら %2 です。</translation>
        </message>
        <message>
            <source>It is %1 large. Is that the right unit? In millimetres it is %2.</source>
            <translation>大きさが %1 あります。単位は正しいですか。ミリメートルなら %2 です。</translation>
        </message>
        <message>
            <source>Use centimetres</source>
            <translation>センチメートルにする</translation>
        </message>
        <message>
            <source>Use millimetres</source>
            <translation>ミリメートルにする</translation>
        </message>
    </context>
    <context>
        <name>imomushi::InspectorPanel</name>
        <message>
            <source>Properties</source>
            <translation>プロパティ</translation>
        </message>
    </context>
    <context>
        <name>imomushi::BoneForm</name>
        <message numerus="yes">
            <source>%n bone(s)</source>
            <translation>
                <numerusform>%n 本のボーン</numerusform>
            </translation>
        </message>
        <message>
            <source>Bone</source>
            <translation>ボーン</translation>
        </message>
        <message>
            <source>Rest</source>
            <translation>静止時</translation>
        </message>
        <message>
            <source>Roll</source>
            <translation>ロール</translation>
        </message>
        <message>
            <source>Stretch limits</source>
            <translation>伸縮の限度</translation>
        </message>
        <message>
            <source>Shortest</source>
            <translation>最短</translation>
        </message>
        <message>
            <source>Longest</source>
            <translation>最長</translation>
        </message>
        <message>
            <source>Turn limits</source>
            <translation>回転の限度</translation>
        </message>
        <message>
            <source>Bend</source>
            <translation>曲げ</translation>
        </message>
        <message>
            <source>Twist</source>
            <translation>ねじり</translation>
        </message>
        <message>
            <source>When pulled</source>
            <translation>引かれたとき</translation>
        </message>
        <message>
            <source>Stiffness</source>
            <translation>硬さ</translation>
        </message>
        <message>
            <source>Weight</source>
            <translation>重さ</translation>
        </message>
        <message>
            <source>automatic</source>
            <translation>自動</translation>
        </message>
        <message>
            <source>none</source>
            <translation>なし</translation>
        </message>
        <message>
            <source>Parent</source>
            <translation>親</translation>
        </message>
        <message>
            <source>Runs through</source>
            <translation>通る要素</translation>
        </message>
        <message>
            <source>Length</source>
            <translation>長さ</translation>
        </message>
        <message>
            <source>Start</source>
            <translation>始点</translation>
        </message>
        <message>
            <source>End</source>
            <translation>終点</translation>
        </message>
        <message>
            <source>Start at rest</source>
            <translation>始点（静止時）</translation>
        </message>
        <message>
            <source>End at rest</source>
            <translation>終点（静止時）</translation>
        </message>
        <message>
            <source>a point</source>
            <translation>点</translation>
        </message>
    </context>
    <context>
        <name>imomushi::CharacterForm</name>
        <message>
            <source>Character</source>
            <translation>キャラクター</translation>
        </message>
        <message>
            <source>Trunk stays upright</source>
            <translation>胴を起こしておく</translation>
        </message>
        <message>
            <source>Number format</source>
            <translation>数値の形式</translation>
        </message>
        <message>
            <source>Float (4 bytes)</source>
            <translation>単精度（4 バイト）</translation>
        </message>
        <message>
            <source>Half (2 bytes)</source>
            <translation>半精度（2 バイト）</translation>
        </message>
        <message>
            <source>Integer (2 bytes)</source>
            <translation>整数（2 バイト）</translation>
        </message>
        <message>
            <source>Format error</source>
            <translation>形式による誤差</translation>
        </message>
        <message>
            <source>%1 %</source>
            <translation>%1 %</translation>
        </message>
        <message>
            <source>All (%1)</source>
            <translation>すべて (%1)</translation>
        </message>
        <message>
            <source>Threads</source>
            <translation>スレッド</translation>
        </message>
        <message>
            <source>Contents</source>
            <translation>内容</translation>
        </message>
        <message>
            <source>Elements</source>
            <translation>要素</translation>
        </message>
        <message>
            <source>Joints</source>
            <translation>関節</translation>
        </message>
        <message>
            <source>Bones</source>
            <translation>ボーン</translation>
        </message>
        <message>
            <source>Vertices</source>
            <translation>頂点</translation>
        </message>
        <message>
            <source>Precomputed</source>
            <translation>前計算済み</translation>
        </message>
        <message>
            <source>nothing to do</source>
            <translation>不要</translation>
        </message>
        <message>
            <source>%1 of %2, %3</source>
            <translation>%1 / %2、%3</translation>
        </message>
        <message>
            <source>Joint shapes</source>
            <translation>関節の形</translation>
        </message>
        <message>
            <source>None</source>
            <translation>なし</translation>
        </message>
        <message>
            <source>None, without twist</source>
            <translation>なし（ねじれなし）</translation>
        </message>
        <message>
            <source>All</source>
            <translation>すべて</translation>
        </message>
        <message>
            <source>%1 Hz</source>
            <translation>%1 Hz</translation>
        </message>
        <message>
            <source>Steps per second</source>
            <translation>毎秒のステップ数</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ElementForm</name>
        <message numerus="yes">
            <source>%n element(s)</source>
            <translation>
                <numerusform>%n 個の要素</numerusform>
            </translation>
        </message>
        <message>
            <source>Element</source>
            <translation>要素</translation>
        </message>
        <message>
            <source>Precompute</source>
            <translation>前計算</translation>
        </message>
        <message>
            <source>Material</source>
            <translation>材質</translation>
        </message>
        <message>
            <source>Poisson ratio</source>
            <translation>ポアソン比</translation>
        </message>
        <message>
            <source>Stiffness</source>
            <translation>硬さ</translation>
        </message>
        <message>
            <source>Density</source>
            <translation>密度</translation>
        </message>
        <message>
            <source>Damping</source>
            <translation>減衰</translation>
        </message>
        <message>
            <source>Preset</source>
            <translation>プリセット</translation>
        </message>
        <message>
            <source>Custom</source>
            <translation>カスタム</translation>
        </message>
        <message>
            <source>%1: sags %2 %</source>
            <translation>%1：垂れ %2 %</translation>
        </message>
        <message>
            <source>Sets the four numbers below. The sag is that of a whole character of this material under default gravity, as a share of its height; the size does not matter.</source>
            <translation>下の 4 つの数値を設定します。「垂れ」は、キャラクター全体がこの材質のとき、既定の重力で垂れ下がる長さ（高さに対する割合）で、大きさによりません。</translation>
        </message>
        <message>
            <source>Colour</source>
            <translation>色</translation>
        </message>
        <message>
            <source>Colour of the element</source>
            <translation>要素の色</translation>
        </message>
        <message>
            <source>Joint planes</source>
            <translation>関節面の向き</translation>
        </message>
        <message>
            <source>Automatic</source>
            <translation>自動</translation>
        </message>
        <message>
            <source>Halfway between bones</source>
            <translation>ボーンの中間</translation>
        </message>
        <message>
            <source>Turn with the element</source>
            <translation>要素とともに回る</translation>
        </message>
        <message>
            <source>Effects here</source>
            <translation>この要素のエフェクト</translation>
        </message>
        <message>
            <source>Mesh</source>
            <translation>メッシュ</translation>
        </message>
        <message>
            <source>Vertices</source>
            <translation>頂点</translation>
        </message>
        <message>
            <source>Triangles</source>
            <translation>三角形</translation>
        </message>
        <message>
            <source>Joint faces</source>
            <translation>関節面</translation>
        </message>
        <message>
            <source>Size</source>
            <translation>大きさ</translation>
        </message>
        <message>
            <source>Volume</source>
            <translation>体積</translation>
        </message>
        <message>
            <source>%1 %</source>
            <translation>%1 %</translation>
        </message>
        <message>
            <source>Solver mesh</source>
            <translation>計算用メッシュ</translation>
        </message>
        <message>
            <source>Default</source>
            <translation>標準</translation>
        </message>
        <message>
            <source>Best</source>
            <translation>最高精度</translation>
        </message>
        <message>
            <source>As it is</source>
            <translation>そのまま</translation>
        </message>
        <message>
            <source>Refined</source>
            <translation>細分</translation>
        </message>
        <message>
            <source>Tetrahedra</source>
            <translation>四面体（有限要素）</translation>
        </message>
        <message>
            <source>Decimated</source>
            <translation>間引き</translation>
        </message>
        <message>
            <source>To vertices</source>
            <translation>目標頂点数</translation>
        </message>
        <message>
            <source>Shared with</source>
            <translation>共有元</translation>
        </message>
        <message>
            <source>State</source>
            <translation>状態</translation>
        </message>
        <message>
            <source>needs a joint face</source>
            <translation>関節面が必要</translation>
        </message>
        <message>
            <source>Up to date</source>
            <translation>最新</translation>
        </message>
        <message>
            <source>Out of date</source>
            <translation>古くなっています</translation>
        </message>
        <message>
            <source>Not yet</source>
            <translation>まだ</translation>
        </message>
        <message>
            <source>Estimated error</source>
            <translation>推定誤差</translation>
        </message>
        <message>
            <source>not known</source>
            <translation>不明</translation>
        </message>
        <message>
            <source>Error of the wrap</source>
            <translation>包んだ面の誤差</translation>
        </message>
        <message>
            <source>Total error</source>
            <translation>合計誤差</translation>
        </message>
        <message>
            <source>Mapping error</source>
            <translation>転写の誤差</translation>
        </message>
        <message>
            <source>Shape error</source>
            <translation>形状の誤差</translation>
        </message>
        <message>
            <source>Time taken</source>
            <translation>かかった時間</translation>
        </message>
        <message>
            <source>Solved on</source>
            <translation>計算の規模</translation>
        </message>
        <message>
            <source>%1 vertices</source>
            <translation>頂点 %1</translation>
        </message>
        <message>
            <source>%1, %2 nodes</source>
            <translation>%1、節点 %2</translation>
        </message>
        <message>
            <source>Columns</source>
            <translation>列数</translation>
        </message>
        <message>
            <source>Memory</source>
            <translation>メモリ</translation>
        </message>
        <message>
            <source>Residual</source>
            <translation>残差</translation>
        </message>
        <message>
            <source>Condition</source>
            <translation>条件数の逆数</translation>
        </message>
        <message>
            <source>Asymmetry</source>
            <translation>非対称性</translation>
        </message>
        <message>
            <source>Typical error</source>
            <translation>誤差の目安</translation>
        </message>
        <message>
            <source>below %1</source>
            <translation>%1 未満</translation>
        </message>
        <message>
            <source>up to %1</source>
            <translation>最大 %1</translation>
        </message>
        <message>
            <source>known afterwards</source>
            <translation>計算後に判明</translation>
        </message>
        <message>
            <source>Will take</source>
            <translation>見込み</translation>
        </message>
        <message>
            <source>about %1, %2</source>
            <translation>約 %1、%2</translation>
        </message>
        <message>
            <source>Draft</source>
            <translation>下書き</translation>
        </message>
    </context>
    <context>
        <name>imomushi::EndpointForm</name>
        <message>
            <source>Hold orientation</source>
            <translation>向きも固定</translation>
        </message>
        <message>
            <source>The pin holds the direction of the bone, too.</source>
            <translation>ピンはボーンの向きも固定します。</translation>
        </message>
        <message>
            <source>Endpoint</source>
            <translation>端点</translation>
        </message>
        <message>
            <source>State</source>
            <translation>状態</translation>
        </message>
        <message>
            <source>free</source>
            <translation>自由</translation>
        </message>
        <message>
            <source>pinned</source>
            <translation>ピン留め</translation>
        </message>
        <message>
            <source>held</source>
            <translation>保持</translation>
        </message>
        <message>
            <source>At rest (m)</source>
            <translation>静止位置 (m)</translation>
        </message>
        <message>
            <source>Now (m)</source>
            <translation>現在位置 (m)</translation>
        </message>
        <message>
            <source>Target</source>
            <translation>目標</translation>
        </message>
        <message>
            <source>Release</source>
            <translation>放す</translation>
        </message>
        <message>
            <source>Unpin</source>
            <translation>ピンを外す</translation>
        </message>
        <message>
            <source>Pin</source>
            <translation>ピン留め</translation>
        </message>
    </context>
    <context>
        <name>imomushi::FaceForm</name>
        <message>
            <source>Joint face</source>
            <translation>関節面</translation>
        </message>
        <message>
            <source>Element</source>
            <translation>要素</translation>
        </message>
        <message>
            <source>Joined with</source>
            <translation>つながり先</translation>
        </message>
        <message>
            <source>nothing</source>
            <translation>なし</translation>
        </message>
        <message>
            <source>Patch</source>
            <translation>範囲</translation>
        </message>
        <message>
            <source>Vertices</source>
            <translation>頂点</translation>
        </message>
        <message>
            <source>Area</source>
            <translation>面積</translation>
        </message>
        <message>
            <source>%1 cm²</source>
            <translation>%1 cm²</translation>
        </message>
        <message>
            <source>Size</source>
            <translation>大きさ</translation>
        </message>
        <message>
            <source>Planarity error</source>
            <translation>平面からのずれ</translation>
        </message>
        <message>
            <source>%1 (flat)</source>
            <translation>%1（平ら）</translation>
        </message>
        <message>
            <source>%1 (not flat: three more columns)</source>
            <translation>%1（平らでない：3 列追加）</translation>
        </message>
        <message>
            <source>Frame</source>
            <translation>座標系</translation>
        </message>
        <message>
            <source>Origin (m)</source>
            <translation>原点 (m)</translation>
        </message>
        <message>
            <source>Normal</source>
            <translation>法線</translation>
        </message>
    </context>
    <context>
        <name>imomushi::HandleForm</name>
        <message>
            <source>Handle</source>
            <translation>ハンドル</translation>
        </message>
        <message>
            <source>Element</source>
            <translation>要素</translation>
        </message>
        <message>
            <source>State</source>
            <translation>状態</translation>
        </message>
        <message>
            <source>free</source>
            <translation>自由</translation>
        </message>
        <message>
            <source>pinned</source>
            <translation>ピン留め</translation>
        </message>
        <message>
            <source>held</source>
            <translation>保持</translation>
        </message>
        <message>
            <source>its element</source>
            <translation>自分の要素</translation>
        </message>
        <message>
            <source>Moves with</source>
            <translation>一緒に動くもの</translation>
        </message>
        <message>
            <source>Disc</source>
            <translation>円板</translation>
        </message>
        <message>
            <source>Radius</source>
            <translation>半径</translation>
        </message>
        <message>
            <source>Vertices</source>
            <translation>頂点</translation>
        </message>
        <message>
            <source>Planarity error</source>
            <translation>平面からのずれ</translation>
        </message>
        <message>
            <source>Target</source>
            <translation>目標</translation>
        </message>
        <message>
            <source>Release</source>
            <translation>放す</translation>
        </message>
        <message>
            <source>Remove</source>
            <translation>削除</translation>
        </message>
        <message>
            <source>Unpin</source>
            <translation>ピンを外す</translation>
        </message>
        <message>
            <source>Pin</source>
            <translation>ピン留め</translation>
        </message>
    </context>
    <context>
        <name>imomushi::InspectorForm</name>
        <message>
            <source>Name</source>
            <translation>名前</translation>
        </message>
        <message>
            <source>%1: %2</source>
            <comment>what, and its value or axis</comment>
            <translation>%1：%2</translation>
        </message>
    </context>
    <context>
        <name>imomushi::IssueModel</name>
        <message>
            <source>%1 · mended</source>
            <translation>%1 · 修復済み</translation>
        </message>
        <message>
            <source>Solved by boundary elements, which are less exact: finite elements could not be used.</source>
            <translation>有限要素を使えなかったため、精度の低い境界要素で解きました。</translation>
        </message>
        <message>
            <source>Has no joint face yet: it cannot deform.</source>
            <translation>関節面がまだないため変形できません。</translation>
        </message>
        <message>
            <source>A link of flesh holds two parts together here.</source>
            <translation>ここで肉のつなぎが二つの部分を支えています。</translation>
        </message>
        <message>
            <source>The body closes a gap here: both sides move as one.</source>
            <translation>ボディがここのすき間を閉じています。両側は一緒に動きます。</translation>
        </message>
        <message>
            <source>Wrap finer</source>
            <translation>細かく包み直す</translation>
        </message>
    </context>
    <context>
        <name>imomushi::IssuesPanel</name>
        <message>
            <source>No issues.</source>
            <translation>問題はありません。</translation>
        </message>
        <message>
            <source>Issues</source>
            <translation>問題</translation>
        </message>
        <message>
            <source>Repair all</source>
            <translation>すべて修復</translation>
        </message>
    </context>
    <context>
        <name>imomushi::JobCard</name>
        <message>
            <source>Cancel</source>
            <translation>キャンセル</translation>
        </message>
    </context>
    <context>
        <name>imomushi::PrecomputeFlow</name>
        <message>
            <source>%1: %2</source>
            <comment>element, what went wrong</comment>
            <translation>%1：%2</translation>
        </message>
        <message>
            <source>Precompute cancelled</source>
            <translation>前計算を中止しました</translation>
        </message>
        <message numerus="yes">
            <source>Precompute cancelled; %n element(s) were done and are kept.</source>
            <translation>
                <numerusform>前計算を中止しました。完了した %n 個の要素の結果は残しました。</numerusform>
            </translation>
        </message>
        <message>
            <source>Precomputed. Drag the end of a bone or a handle with the drag tool (D).</source>
            <translation>前計算が終わりました。ドラッグツール (D) でボーンの端やハンドルを動かせます。</translation>
        </message>
        <message>
            <source>Everything is precomputed already.</source>
            <translation>すべて前計算済みです。</translation>
        </message>
    </context>
    <context>
        <name>imomushi::MainWindow</name>
        <message>
            <source>Drawing “%1”</source>
            <translation>「%1」を描画しています</translation>
        </message>
        <message>
            <source>Play</source>
            <translation>再生</translation>
        </message>
        <message>
            <source>Recorded “%1”, %2 s</source>
            <translation>「%1」を記録しました（%2 秒）</translation>
        </message>
        <message>
            <source>Precomputing %1</source>
            <translation>%1 を前計算中</translation>
        </message>
        <message>
            <source>Precomputing %1 %</source>
            <translation>前計算中 %1 %</translation>
        </message>
        <message>
            <source>View of the character</source>
            <translation>キャラクターのビュー</translation>
        </message>
        <message>
            <source>Status</source>
            <translation>ステータス</translation>
        </message>
        <message>
            <source>New project</source>
            <translation>新しいプロジェクト</translation>
        </message>
        <message>
            <source>Joined %1 and %2</source>
            <translation>%1 と %2 を結合しました</translation>
        </message>
        <message>
            <source>Place bones</source>
            <translation>ボーンを置く</translation>
        </message>
        <message>
            <source>Mending %1</source>
            <translation>%1 を修復中</translation>
        </message>
        <message>
            <source>Undo</source>
            <translation>元に戻す</translation>
        </message>
        <message>
            <source>Mirrored</source>
            <translation>ミラーしました</translation>
        </message>
        <message>
            <source>Looking at the bones of “%1”</source>
            <translation>「%1」のボーンを調べています</translation>
        </message>
        <message>
            <source>Cancelled; nothing has changed.</source>
            <translation>中止しました。何も変わっていません。</translation>
        </message>
        <message>
            <source>Make it soft</source>
            <translation>柔らかくする</translation>
        </message>
        <message>
            <source>Finding limbs of %1</source>
            <comment>a character</comment>
            <translation>%1 の手足を探しています</translation>
        </message>
        <message>
            <source>The proposal is kept as it is.</source>
            <translation>提案はそのまま残っています。</translation>
        </message>
        <message>
            <source>Show it</source>
            <translation>表示</translation>
        </message>
        <message>
            <source>Save a picture</source>
            <translation>画像を保存</translation>
        </message>
        <message>
            <source>Pictures (*.png)</source>
            <translation>画像 (*.png)</translation>
        </message>
        <message>
            <source>Wrote “%1”</source>
            <translation>「%1」を書き出しました</translation>
        </message>
        <message>
            <source>Not now</source>
            <translation>今はできません</translation>
        </message>
        <message>
            <source>Panel</source>
            <translation>パネル</translation>
        </message>
        <message>
            <source>Effect</source>
            <translation>エフェクト</translation>
        </message>
        <message>
            <source>Setting of “%1”</source>
            <comment>an effect</comment>
            <translation>「%1」の設定</translation>
        </message>
        <message>
            <source>Setting</source>
            <translation>設定</translation>
        </message>
        <message>
            <source>Sample</source>
            <translation>サンプル</translation>
        </message>
        <message>
            <source>Character</source>
            <translation>キャラクター</translation>
        </message>
        <message>
            <source>Cut</source>
            <translation>切断</translation>
        </message>
        <message>
            <source>Clip</source>
            <translation>クリップ</translation>
        </message>
        <message>
            <source>Element</source>
            <translation>要素</translation>
        </message>
        <message>
            <source>Handle</source>
            <translation>ハンドル</translation>
        </message>
        <message>
            <source>Joint face of %1</source>
            <comment>an element</comment>
            <translation>%1 の関節面</translation>
        </message>
        <message>
            <source>Bone</source>
            <translation>ボーン</translation>
        </message>
        <message>
            <source>Take</source>
            <translation>テイク</translation>
        </message>
        <message>
            <source>Choose a sample, or drop a file on the window · Help &gt; Mouse and keys lists all keys</source>
            <translation>サンプルを選ぶか、ウィンドウにファイルをドロップしてください · すべてのキーは「ヘルプ」&gt;「マウスとキー」にあります</translation>
        </message>
        <message>
            <source>Mappings (*.json)</source>
            <translation>対応づけ (*.json)</translation>
        </message>
        <message>
            <source>Load mappings</source>
            <translation>対応づけを読み込む</translation>
        </message>
        <message>
            <source>Save mappings</source>
            <translation>対応づけを保存</translation>
        </message>
        <message numerus="yes">
            <source>%n mapping(s) loaded.</source>
            <translation>
                <numerusform>%n 件の対応づけを読み込みました。</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n of them wait(s) for what the character does not have.</source>
            <translation>
                <numerusform>そのうち %n 件は、キャラクターにないものを待ちます。</numerusform>
            </translation>
        </message>
        <message>
            <source>Copied the settings</source>
            <translation>設定をコピーしました</translation>
        </message>
        <message>
            <source>End of a bone</source>
            <translation>ボーンの端</translation>
        </message>
        <message numerus="yes">
            <source>%n mapping(s) made. Change them as you like.</source>
            <translation><numerusform>%n 個の対応づけを作りました。自由に変えられます。</numerusform></translation>
        </message>
        <message>
            <source>“%1” is built. It is your project now: each step can be undone.</source>
            <translation>「%1」ができました。これはもうあなたのプロジェクトで、どのステップも元に戻せます。</translation>
        </message>
    </context>
    <context>
        <name>imomushi::AboutDialog</name>
        <message>
            <source>About Imomushi</source>
            <translation>Imomushi について</translation>
        </message>
        <message>
            <source>Articulated elastic characters in real time.</source>
            <translation>関節のある弾性キャラクターを実時間で動かします。</translation>
        </message>
        <message>
            <source>Free software under the GNU General Public License, version 3 or later.</source>
            <translation>GNU 一般公衆ライセンス第 3 版またはそれ以降に基づく自由ソフトウェアです。</translation>
        </message>
        <message>
            <source>Close</source>
            <translation>閉じる</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ActionStates</name>
        <message>
            <source>Undo: %1</source>
            <translation>元に戻す：%1</translation>
        </message>
        <message>
            <source>Redo: %1</source>
            <translation>やり直す：%1</translation>
        </message>
        <message>
            <source>Select something first.</source>
            <translation>先に何かを選んでください。</translation>
        </message>
        <message>
            <source>There is no character: import one, or select one of several.</source>
            <translation>キャラクターがありません。読み込むか、いくつかある場合は 1 つを選んでください。</translation>
        </message>
        <message>
            <source>Wait until the running task is done, or cancel it.</source>
            <translation>実行中の処理が終わるまで待つか、取り消してください。</translation>
        </message>
        <message>
            <source>Versions are kept once the project is saved.</source>
            <translation>バージョンは、プロジェクトを保存すると残るようになります。</translation>
        </message>
        <message>
            <source>Select one thing that has a name.</source>
            <translation>名前のあるものをひとつ選んでください。</translation>
        </message>
        <message>
            <source>Select an element, a character or a bone first.</source>
            <translation>先に要素かキャラクターかボーンを選んでください。</translation>
        </message>
        <message>
            <source>Select one character, or one element of its own.</source>
            <translation>キャラクターか、単独の要素をひとつ選んでください。</translation>
        </message>
        <message>
            <source>It is soft already: it has cuts, bones or handles.</source>
            <translation>すでに柔らかくなっています。切断かボーンかハンドルがあります。</translation>
        </message>
        <message>
            <source>It has no skeleton. “Import skeleton” adds one.</source>
            <translation>骨格がありません。「骨格を読み込む」で加えられます。</translation>
        </message>
        <message>
            <source>Select two joint faces: click one, then Shift+click the other.</source>
            <translation>関節面を 2 つ選んでください。1 つ目をクリックし、もう 1 つを Shift+クリックします。</translation>
        </message>
        <message>
            <source>Select a bone, the end of one, or a handle first.</source>
            <translation>先にボーンか、その端か、ハンドルを選んでください。</translation>
        </message>
        <message>
            <source>Nothing is held.</source>
            <translation>保持しているものはありません。</translation>
        </message>
        <message>
            <source>It is at rest.</source>
            <translation>静止しています。</translation>
        </message>
        <message>
            <source>The project is empty.</source>
            <translation>プロジェクトは空です。</translation>
        </message>
        <message>
            <source>It is precomputing.</source>
            <translation>前計算中です。</translation>
        </message>
        <message>
            <source>Everything is precomputed already.</source>
            <translation>すべて前計算済みです。</translation>
        </message>
        <message>
            <source>There is nothing to precompute: no element has a joint face or a handle.</source>
            <translation>前計算するものがありません。関節面やハンドルのある要素がありません。</translation>
        </message>
        <message>
            <source>There is nothing to undo.</source>
            <translation>元に戻す操作がありません。</translation>
        </message>
        <message>
            <source>There is nothing to redo.</source>
            <translation>やり直す操作がありません。</translation>
        </message>
        <message>
            <source>There is nothing to perform with yet: open a sample, or make a mesh soft.</source>
            <translation>演じられるものがまだありません。サンプルを開くか、メッシュを柔らかくしてください。</translation>
        </message>
        <message>
            <source>The character has no clips that its bones could play.</source>
            <translation>キャラクターには、ボーンで再生できるクリップがありません。</translation>
        </message>
        <message>
            <source>A take is being recorded.</source>
            <translation>テイクを記録中です。</translation>
        </message>
        <message>
            <source>There is no take yet: record one.</source>
            <translation>テイクがまだありません。記録してください。</translation>
        </message>
        <message>
            <source>The whole take is selected already. Set a mark first.</source>
            <translation>すでにテイク全体が選ばれています。先に目印を付けてください。</translation>
        </message>
        <message>
            <source>No take is shown.</source>
            <translation>テイクは表示されていません。</translation>
        </message>
        <message>
            <source>There is nothing to make soft: import a mesh, or select one of several characters and elements.</source>
            <translation>柔らかくするものがありません。メッシュを読み込むか、キャラクターや要素のうち 1 つを選んでください。</translation>
        </message>
        <message>
            <source>It has joint faces, bones or handles: precompute makes it soft.</source>
            <translation>関節面かボーンかハンドルがあります。前計算をすると柔らかくなります。</translation>
        </message>
        <message>
            <source>Nobody is listened to.</source>
            <translation>どの送り手も聞いていません。</translation>
        </message>
        <message>
            <source>There are no mappings.</source>
            <translation>対応づけがありません。</translation>
        </message>
        <message>
            <source>Select an element or a bone first.</source>
            <translation>先に要素かボーンを選択してください。</translation>
        </message>
        <message>
            <source>Select a bone first.</source>
            <translation>先にボーンを選択してください。</translation>
        </message>
        <message>
            <source>There are no bones and no handles yet.</source>
            <translation>ボーンもハンドルもまだありません。</translation>
        </message>
        <message>
            <source>So many poses are not kept yet.</source>
            <translation>その番号のポーズはまだ保存されていません。</translation>
        </message>
        <message>
            <source>Nothing was copied yet.</source>
            <translation>まだ何もコピーしていません。</translation>
        </message>
        <message>
            <source>Select one joint face first.</source>
            <translation>先に関節面を 1 つ選んでください。</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ControlsDialog</name>
        <message>
            <source>Turn the view</source>
            <translation>視点を回す</translation>
        </message>
        <message>
            <source>Middle mouse button</source>
            <translation>中ボタン</translation>
        </message>
        <message>
            <source>Alt + left mouse button</source>
            <translation>Alt + 左ボタン</translation>
        </message>
        <message>
            <source>Move the view</source>
            <translation>視点を動かす</translation>
        </message>
        <message>
            <source>Shift + middle mouse button</source>
            <translation>Shift + 中ボタン</translation>
        </message>
        <message>
            <source>Alt + middle mouse button</source>
            <translation>Alt + 中ボタン</translation>
        </message>
        <message>
            <source>Nearer, farther</source>
            <translation>近づく、遠ざかる</translation>
        </message>
        <message>
            <source>Wheel</source>
            <translation>ホイール</translation>
        </message>
        <message>
            <source>Wheel, Alt + right mouse button</source>
            <translation>ホイール、Alt + 右ボタン</translation>
        </message>
        <message>
            <source>Select</source>
            <translation>選択</translation>
        </message>
        <message>
            <source>Click, or drag a box from nothing, with Ctrl a loop; Shift adds</source>
            <translation>クリック、または何もない所から範囲をドラッグ（Ctrl で投げ縄、Shift で追加）</translation>
        </message>
        <message>
            <source>Take back what is unfinished</source>
            <translation>途中の操作を取り消す</translation>
        </message>
        <message>
            <source>Esc or right mouse button</source>
            <translation>Esc または右ボタン</translation>
        </message>
        <message>
            <source>Views along the axes</source>
            <translation>軸方向の視点</translation>
        </message>
        <message>
            <source>Mouse and keys</source>
            <translation>マウスとキー</translation>
        </message>
        <message>
            <source>Close</source>
            <translation>閉じる</translation>
        </message>
        <message>
            <source>Let go of what is dragged or pinned</source>
            <translation>ドラッグやピン留めを放す</translation>
        </message>
        <message>
            <source>Double click with the drag tool</source>
            <translation>ドラッグツールでダブルクリック</translation>
        </message>
        <message>
            <source>With or without perspective</source>
            <translation>透視図と平行投影の切り替え</translation>
        </message>
        <message>
            <source>Turn by 15°</source>
            <translation>15° 回す</translation>
        </message>
        <message>
            <source>4, 6, 8, 2 of the keypad</source>
            <translation>テンキーの 4、6、8、2</translation>
        </message>
        <message>
            <source>The end of a bone behind the one under the pointer</source>
            <translation>ポインターの下の、奥にあるボーンの端</translation>
        </message>
        <message>
            <source>Tab, or a second click</source>
            <translation>Tab、またはもう一度クリック</translation>
        </message>
        <message>
            <source>Pin what is under the pointer, with the drag tool</source>
            <translation>ポインターの下をピン留め（ドラッグツール）</translation>
        </message>
        <message>
            <source>While dragging: along one axis</source>
            <translation>ドラッグ中：ひとつの軸に沿う</translation>
        </message>
        <message>
            <source>While dragging: turn</source>
            <translation>ドラッグ中：回す</translation>
        </message>
        <message>
            <source>R or wheel</source>
            <translation>R かホイール</translation>
        </message>
        <message>
            <source>While dragging: finer, in steps</source>
            <translation>ドラッグ中：微調整、刻み</translation>
        </message>
        <message>
            <source>Shift, Ctrl</source>
            <translation>Shift、Ctrl</translation>
        </message>
        <message>
            <source>While dragging flesh: keep the temporary handle</source>
            <translation>肉をドラッグ中：一時ハンドルを残す</translation>
        </message>
        <message>
            <source>The selected joint face, with its tool: larger, smaller, brush, add a flat region</source>
            <translation>選択した関節面（そのツールで）：広く、狭く、ブラシ、平らな部分を加える</translation>
        </message>
        <message>
            <source>Cut here, or accept a proposal</source>
            <translation>ここで切る、提案を受け入れる</translation>
        </message>
        <message>
            <source>Enter</source>
            <translation>Enter</translation>
        </message>
        <message>
            <source>Mouse</source>
            <translation>マウス</translation>
        </message>
        <message>
            <source>Keys in the view</source>
            <translation>ビューのキー</translation>
        </message>
        <message>
            <source>Keys of commands</source>
            <translation>コマンドのキー</translation>
        </message>
        <message>
            <source>While dragging the end of a bone: the trunk leans, too, or stays upright</source>
            <translation>ボーンの端をドラッグ中：胴も傾ける、または起こしておく</translation>
        </message>
        <message>
            <source>While dragging: across an axis</source>
            <translation>ドラッグ中：軸に垂直な平面上</translation>
        </message>
        <message>
            <source>While dragging: how far, how much</source>
            <translation>ドラッグ中：どれだけ動かすか</translation>
        </message>
        <message>
            <source>Numbers, like 12 cm, 30°, *1.5 or 1/3; Tab, Backspace, Enter</source>
            <translation>数値（12 cm、30°、*1.5、1/3 など）。Tab、Backspace、Enter</translation>
        </message>
        <message>
            <source>Without a button: move, turn and scale what is selected</source>
            <translation>ボタンを押さずに：選択したものを移動、回転、拡大縮小</translation>
        </message>
    </context>
    <context>
        <name>imomushi::StudioDocks</name>
        <message>
            <source>Panels</source>
            <translation>パネル</translation>
        </message>
        <message>
            <source>Outliner</source>
            <translation>アウトライナー</translation>
        </message>
        <message>
            <source>History</source>
            <translation>履歴</translation>
        </message>
        <message>
            <source>Properties</source>
            <translation>プロパティ</translation>
        </message>
        <message>
            <source>Effects</source>
            <translation>エフェクト</translation>
        </message>
        <message>
            <source>Accuracy and cost</source>
            <translation>精度とコスト</translation>
        </message>
        <message>
            <source>Takes</source>
            <translation>テイク</translation>
        </message>
        <message>
            <source>Issues (%1)</source>
            <translation>問題 (%1)</translation>
        </message>
        <message>
            <source>Issues</source>
            <translation>問題</translation>
        </message>
        <message>
            <source>Live inputs</source>
            <translation>ライブ入力</translation>
        </message>
        <message>
            <source>Poses</source>
            <translation>ポーズ</translation>
        </message>
    </context>
    <context>
        <name>imomushi::StudioMenus</name>
        <message>
            <source>&amp;File</source>
            <translation>ファイル(&amp;F)</translation>
        </message>
        <message>
            <source>Open &amp;recent</source>
            <translation>最近使ったファイル(&amp;R)</translation>
        </message>
        <message>
            <source>Sa&amp;mples</source>
            <translation>サンプル(&amp;M)</translation>
        </message>
        <message>
            <source>&amp;Edit</source>
            <translation>編集(&amp;E)</translation>
        </message>
        <message>
            <source>&amp;Character</source>
            <translation>キャラクター(&amp;C)</translation>
        </message>
        <message>
            <source>&amp;View</source>
            <translation>表示(&amp;V)</translation>
        </message>
        <message>
            <source>&amp;Panels</source>
            <translation>パネル(&amp;P)</translation>
        </message>
        <message>
            <source>&amp;Theme</source>
            <translation>テーマ(&amp;T)</translation>
        </message>
        <message>
            <source>&amp;Language</source>
            <translation>言語(&amp;L)</translation>
        </message>
        <message>
            <source>Menus</source>
            <translation>メニュー</translation>
        </message>
        <message>
            <source>Tools</source>
            <translation>ツール</translation>
        </message>
        <message>
            <source>%1 (missing)</source>
            <translation>%1（見つかりません）</translation>
        </message>
        <message>
            <source>Perf&amp;orm</source>
            <translation>演技(&amp;O)</translation>
        </message>
        <message>
            <source>Hel&amp;p</source>
            <translation>ヘルプ(&amp;P)</translation>
        </message>
        <message>
            <source>Poses</source>
            <translation>ポーズ</translation>
        </message>
        <message>
            <source>S&amp;nap</source>
            <translation>スナップ(&amp;N)</translation>
        </message>
        <message>
            <source>Gi&amp;zmo</source>
            <translation>ギズモ(&amp;Z)</translation>
        </message>
        <message>
            <source>Place b&amp;y numbers</source>
            <translation>数値で置く(&amp;Y)</translation>
        </message>
        <message>
            <source>How samples were &amp;built</source>
            <translation>サンプルの作られ方(&amp;B)</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ManualDialog</name>
        <message>
            <source>Manual</source>
            <translation>マニュアル</translation>
        </message>
        <message>
            <source>Back</source>
            <translation>戻る</translation>
        </message>
        <message>
            <source>Forward</source>
            <translation>進む</translation>
        </message>
        <message>
            <source>Close</source>
            <translation>閉じる</translation>
        </message>
        <message>
            <source>Search the manual</source>
            <translation>マニュアルを検索</translation>
        </message>
        <message>
            <source>Contents</source>
            <translation>目次</translation>
        </message>
        <message>
            <source>en</source>
            <comment>folder of the manual in this language</comment>
            <translation>ja</translation>
        </message>
    </context>
    <context>
        <name>imomushi::MeshPreview</name>
        <message>
            <source>Preview of the mesh</source>
            <translation>メッシュのプレビュー</translation>
        </message>
    </context>
    <context>
        <name>imomushi::MessageBar</name>
        <message>
            <source>Close</source>
            <translation>閉じる</translation>
        </message>
    </context>
    <context>
        <name>imomushi::NumberField</name>
        <message>
            <source>Back to the default</source>
            <translation>既定値に戻す</translation>
        </message>
        <message>
            <source>Drag sideways, or click and type</source>
            <translation>横にドラッグするか、クリックして入力</translation>
        </message>
        <message>
            <source>different</source>
            <translation>複数の値</translation>
        </message>
    </context>
    <context>
        <name>imomushi::OutlinerModel</name>
        <message>
            <source>Joints</source>
            <translation>関節</translation>
        </message>
        <message>
            <source>Effects</source>
            <translation>効果</translation>
        </message>
        <message>
            <source>automatic</source>
            <translation>自動</translation>
        </message>
        <message>
            <source>On: click to turn off</source>
            <translation>オン：クリックでオフ</translation>
        </message>
        <message>
            <source>Character</source>
            <translation>キャラクター</translation>
        </message>
        <message>
            <source>Bones</source>
            <translation>ボーン</translation>
        </message>
        <message>
            <source>Precomputed</source>
            <translation>前計算済み</translation>
        </message>
        <message>
            <source>Out of date: precompute again</source>
            <translation>古くなっています：もう一度前計算してください</translation>
        </message>
        <message>
            <source>Not precomputed yet</source>
            <translation>まだ前計算していません</translation>
        </message>
        <message>
            <source>Visible: click to hide</source>
            <translation>表示中：クリックで隠す</translation>
        </message>
        <message>
            <source>Hidden: click to show</source>
            <translation>非表示：クリックで表示</translation>
        </message>
        <message>
            <source>Locked: click to unlock</source>
            <translation>ロック中：クリックで解除</translation>
        </message>
        <message>
            <source>Not locked: click to lock</source>
            <translation>ロックなし：クリックでロック</translation>
        </message>
        <message>
            <source>Scene</source>
            <translation>シーン</translation>
        </message>
        <message>
            <source>Draft: precompute for the accurate result</source>
            <translation>下書き：前計算でより正確になります</translation>
        </message>
        <message>
            <source>Some are hidden: click to hide all</source>
            <translation>一部が非表示です。クリックですべて隠します</translation>
        </message>
        <message>
            <source>Some are locked: click to lock all</source>
            <translation>一部がロックされています。クリックですべてロックします</translation>
        </message>
    </context>
    <context>
        <name>imomushi::OutlinerPanel</name>
        <message>
            <source>Filter</source>
            <translation>絞り込み</translation>
        </message>
        <message>
            <source>Filter the outliner</source>
            <translation>アウトライナーを絞り込む</translation>
        </message>
        <message>
            <source>Outliner</source>
            <translation>アウトライナー</translation>
        </message>
    </context>
    <context>
        <name>imomushi::PreferencesDialog</name>
        <message>
            <source>Versions of a project</source>
            <translation>プロジェクトのバージョン</translation>
        </message>
        <message>
            <source>None</source>
            <translation>残さない</translation>
        </message>
        <message>
            <source>Memory for precomputed results</source>
            <translation>前計算の結果に使うメモリ</translation>
        </message>
        <message>
            <source>Disk space for precomputed results</source>
            <translation>前計算の結果に使うディスク</translation>
        </message>
        <message>
            <source>Up to %1 GB</source>
            <translation>%1 GB まで</translation>
        </message>
        <message>
            <source>Preferences</source>
            <translation>設定</translation>
        </message>
        <message>
            <source>Theme</source>
            <translation>テーマ</translation>
        </message>
        <message>
            <source>Dark</source>
            <translation>ダーク</translation>
        </message>
        <message>
            <source>Light</source>
            <translation>ライト</translation>
        </message>
        <message>
            <source>High contrast</source>
            <translation>ハイコントラスト</translation>
        </message>
        <message>
            <source>Language</source>
            <translation>言語</translation>
        </message>
        <message>
            <source>As the desktop</source>
            <translation>デスクトップに合わせる</translation>
        </message>
        <message>
            <source>Size of the interface</source>
            <translation>画面の大きさ</translation>
        </message>
        <message>
            <source>Mouse in the view</source>
            <translation>ビューのマウス操作</translation>
        </message>
        <message>
            <source>Like Blender (middle button)</source>
            <translation>Blender 風（中ボタン）</translation>
        </message>
        <message>
            <source>Like Maya (Alt and buttons)</source>
            <translation>Maya 風（Alt とボタン）</translation>
        </message>
        <message>
            <source>Deform on</source>
            <translation>変形の計算</translation>
        </message>
        <message>
            <source>Steps that can be undone</source>
            <translation>元に戻せる手順の数</translation>
        </message>
        <message>
            <source>Automatic</source>
            <translation>自動</translation>
        </message>
        <message>
            <source>Processor</source>
            <translation>プロセッサー</translation>
        </message>
        <message>
            <source>Graphics card</source>
            <translation>グラフィックカード</translation>
        </message>
        <message>
            <source>Picture</source>
            <translation>画質</translation>
        </message>
        <message>
            <source>Fast, for slow machines</source>
            <translation>速度優先（遅いマシン向け）</translation>
        </message>
        <message>
            <source>Fine at all times</source>
            <translation>常に高画質</translation>
        </message>
        <message>
            <source>General</source>
            <translation>一般</translation>
        </message>
        <message>
            <source>Command</source>
            <translation>コマンド</translation>
        </message>
        <message>
            <source>Shortcut</source>
            <translation>ショートカット</translation>
        </message>
        <message>
            <source>Shortcuts</source>
            <translation>ショートカット</translation>
        </message>
        <message>
            <source>Reset all shortcuts</source>
            <translation>すべて既定に戻す</translation>
        </message>
        <message>
            <source>Close</source>
            <translation>閉じる</translation>
        </message>
        <message>
            <source>%1 is used by: %2</source>
            <comment>shortcut, commands</comment>
            <translation>%1 の割り当て先：%2</translation>
        </message>
        <message>
            <source>Press keys</source>
            <translation>キーを押す</translation>
        </message>
    </context>
    <context>
        <name>imomushi::RecoveryDialog</name>
        <message>
            <source>%1 · older than the saved file</source>
            <comment>name, date and time</comment>
            <translation>%1 · 保存されたファイルより古い</translation>
        </message>
        <message>
            <source>Unsaved work</source>
            <translation>保存されていない作業</translation>
        </message>
        <message>
            <source>Imomushi ended before this was saved. Go on where you were?</source>
            <translation>保存する前に Imomushi が終了しました。続きから再開しますか？</translation>
        </message>
        <message>
            <source>New project, never saved</source>
            <translation>新規プロジェクト（未保存）</translation>
        </message>
        <message>
            <source>%1 · %2</source>
            <comment>name, date and time</comment>
            <translation>%1 · %2</translation>
        </message>
        <message>
            <source>Delete</source>
            <translation>削除</translation>
        </message>
        <message>
            <source>Not now</source>
            <translation>後で</translation>
        </message>
        <message>
            <source>Recover</source>
            <translation>復旧</translation>
        </message>
    </context>
    <context>
        <name>imomushi::VersionsDialog</name>
        <message>
            <source>Versions of “%1”</source>
            <translation>「%1」のバージョン</translation>
        </message>
        <message>
            <source>A version is kept whenever a saved project is saved again. There is none yet.</source>
            <translation>保存済みのプロジェクトを再び保存するたびに、バージョンが残ります。まだありません。</translation>
        </message>
        <message>
            <source>As it was saved. A version opens as an unsaved copy; the project stays as it is.</source>
            <translation>保存したときの状態です。バージョンは未保存のコピーとして開き、プロジェクトはそのまま残ります。</translation>
        </message>
        <message>
            <source>Versions</source>
            <translation>バージョン</translation>
        </message>
        <message>
            <source>%1 · %2</source>
            <comment>date and time, size</comment>
            <translation>%1 · %2</translation>
        </message>
        <message>
            <source>Cancel</source>
            <translation>キャンセル</translation>
        </message>
        <message>
            <source>Open</source>
            <translation>開く</translation>
        </message>
    </context>
    <context>
        <name>imomushi::RepairFlow</name>
        <message>
            <source>Repair cancelled</source>
            <translation>修復を取りやめました</translation>
        </message>
        <message>
            <source>“%1” has nothing that can be repaired.</source>
            <translation>「%1」に修復できるものはありませんでした。</translation>
        </message>
        <message>
            <source>“%1”: %2 before, %3 after.</source>
            <translation>「%1」：修復前 %2、修復後 %3。</translation>
        </message>
        <message numerus="yes">
            <source>%n issue(s)</source>
            <translation>
                <numerusform>%n 件</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n</source>
            <comment>issues that are left</comment>
            <translation>
                <numerusform>%n 件</numerusform>
            </translation>
        </message>
        <message>
            <source>none</source>
            <translation>なし</translation>
        </message>
        <message>
            <source>The body: %1.</source>
            <translation>ボディ：%1。</translation>
        </message>
    </context>
    <context>
        <name>imomushi::StartPage</name>
        <message>
            <source>Five elements in a row</source>
            <translation>一列に並んだ 5 つの要素</translation>
        </message>
        <message>
            <source>A body with eight arms</source>
            <translation>胴体と 8 本の腕</translation>
        </message>
        <message>
            <source>Head, trunk, arms and legs</source>
            <translation>頭、胴、腕、脚</translation>
        </message>
        <message>
            <source>A rigged file, made soft</source>
            <translation>リグ付きファイルを柔らかく</translation>
        </message>
        <message>
            <source>Caterpillar</source>
            <translation>イモムシ</translation>
        </message>
        <message>
            <source>Octopus</source>
            <translation>タコ</translation>
        </message>
        <message>
            <source>Cartoon figure</source>
            <translation>カートゥーンの人物</translation>
        </message>
        <message>
            <source>Baby dragon</source>
            <translation>ドラゴンの赤ちゃん</translation>
        </message>
        <message>
            <source>Soft characters that bend, stretch and squash as you drag them</source>
            <translation>引っぱると曲がり、伸び、つぶれる柔らかいキャラクター</translation>
        </message>
        <message>
            <source>Open a project…</source>
            <translation>プロジェクトを開く…</translation>
        </message>
        <message>
            <source>Empty project</source>
            <translation>空のプロジェクト</translation>
        </message>
        <message>
            <source>Samples</source>
            <translation>サンプル</translation>
        </message>
        <message>
            <source>Recent projects</source>
            <translation>最近のプロジェクト</translation>
        </message>
        <message>
            <source>File is missing</source>
            <translation>ファイルが見つかりません</translation>
        </message>
        <message>
            <source>Remove from this list</source>
            <translation>この一覧から外す</translation>
        </message>
        <message>
            <source>Or drop meshes (OBJ, PLY, STL, glTF, FBX, DAE) and projects anywhere on this window.</source>
            <translation>メッシュ（OBJ、PLY、STL、glTF、FBX、DAE）やプロジェクトは、ここへドロップしても開けます。</translation>
        </message>
        <message>
            <source>From a sample</source>
            <translation>サンプルから</translation>
        </message>
        <message>
            <source>%1 opens, ready to be dragged. The others are below.</source>
            <translation>「%1」を開いて、すぐにドラッグできます。ほかのサンプルは下にあります。</translation>
        </message>
        <message>
            <source>From a mesh</source>
            <translation>メッシュから</translation>
        </message>
        <message>
            <source>Any mesh of a creature. Cuts and bones follow its shape; seconds later you can drag it.</source>
            <translation>生き物のメッシュなら何でも。形に合わせて切断とボーンを作り、数秒後にはドラッグできます。</translation>
        </message>
        <message>
            <source>From a rigged file</source>
            <translation>リグ付きファイルから</translation>
        </message>
        <message>
            <source>glTF, VRM, FBX or DAE with a skeleton: its bones become soft limbs, its clips takes.</source>
            <translation>骨格のある glTF、VRM、FBX、DAE。ボーンは柔らかい手足に、クリップはテイクになります。</translation>
        </message>
        <message>
            <source>Watch how it was built</source>
            <translation>作られ方を見る</translation>
        </message>
        <message>
            <source>Watch how “%1” was built</source>
            <translation>「%1」の作られ方を見る</translation>
        </message>
    </context>
    <context>
        <name>imomushi::StatusStrip</name>
        <message>
            <source>%1 · slowed to %2 %</source>
            <comment>frames per second, share of real time</comment>
            <translation>%1 · 実時間の %2 %</translation>
        </message>
        <message>
            <source>A step takes longer than its time: time in the performance passes more slowly. Takes keep their times.
Turn effects off or make bodies simpler to have it in real time.</source>
            <translation>1 ステップの計算がその時間より長くかかるため、演技の時間がゆっくり進んでいます。テイクの時刻は変わりません。
実時間に戻すには、エフェクトをオフにするか、ボディを簡単にしてください。</translation>
        </message>
        <message>
            <source>%1 vertices</source>
            <translation>頂点 %1</translation>
        </message>
        <message>
            <source>%1 of %2 out of date</source>
            <translation>%2 個中 %1 個が古い</translation>
        </message>
        <message>
            <source>Precompute what is out of date (P)</source>
            <translation>古くなったものを前計算する (P)</translation>
        </message>
        <message>
            <source>%1 of %2 out of date · about %3, %4</source>
            <translation>%2 個中 %1 個が古い · 約 %3、%4</translation>
        </message>
        <message>
            <source>Precompute what is out of date (P): about %1, %2</source>
            <translation>古くなったものを前計算する (P)：約 %1、%2</translation>
        </message>
        <message>
            <source>State of the precompute: %1</source>
            <translation>前計算の状態：%1</translation>
        </message>
        <message>
            <source>latency %1 ms</source>
            <translation>遅延 %1 ms</translation>
        </message>
        <message>
            <source>From an input (mouse, controller, network) to its picture on the screen: median %1 ms, 99th percentile %2 ms</source>
            <translation>入力（マウス、コントローラー、ネットワーク）から画面に映るまで：中央値 %1 ms、99 パーセンタイル %2 ms</translation>
        </message>
        <message>
            <source>Frames per second of the viewport</source>
            <translation>ビューの毎秒フレーム数</translation>
        </message>
        <message>
            <source>Processor time of one frame, with drawing.
Of that: bones %1 ms, joints %2 ms, surfaces %3 ms, normals %4 ms</source>
            <translation>1 フレームの処理時間（描画を含む）。
内訳：ボーン %1 ms、関節 %2 ms、表面 %3 ms、法線 %4 ms</translation>
        </message>
        <message>
            <source>Soft as a draft</source>
            <translation>下書きで柔らかい</translation>
        </message>
        <message>
            <source>Precompute what is a draft (P)</source>
            <translation>下書きを前計算する（P）</translation>
        </message>
        <message>
            <source>Soft</source>
            <translation>柔らかい</translation>
        </message>
        <message>
            <source>Precomputed: all elements are up to date</source>
            <translation>前計算済み：すべての要素が最新です</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ViewportWidget</name>
        <message>
            <source>3D view</source>
            <translation>3D ビュー</translation>
        </message>
        <message>
            <source>The 3D view needs OpenGL 3.3. Update the graphics driver, or start with LIBGL_ALWAYS_SOFTWARE=1.</source>
            <translation>3D ビューには OpenGL 3.3 が必要です。グラフィックスドライバーを更新するか、LIBGL_ALWAYS_SOFTWARE=1 を付けて起動してください。</translation>
        </message>
        <message>
            <source>Middle: orbit · Shift+middle: pan · Wheel: zoom</source>
            <translation>中ボタン：回転 · Shift+中ボタン：移動 · ホイール：拡大縮小</translation>
        </message>
        <message>
            <source>Alt+left: orbit · Alt+middle: pan · Wheel: zoom</source>
            <translation>Alt+左：回転 · Alt+中：移動 · ホイール：拡大縮小</translation>
        </message>
        <message>
            <source>Unpin</source>
            <translation>ピンを外す</translation>
        </message>
        <message>
            <source>Pin</source>
            <translation>ピン留め</translation>
        </message>
        <message>
            <source>Let go</source>
            <translation>放す</translation>
        </message>
        <message>
            <source>Frame selection</source>
            <translation>選択範囲を表示</translation>
        </message>
        <message>
            <source>Frame all</source>
            <translation>全体を表示</translation>
        </message>
        <message>
            <source>Remove</source>
            <translation>削除</translation>
        </message>
        <message>
            <source>%1 – drag the character to leave it</source>
            <comment>a take that is shown</comment>
            <translation>%1 – キャラクターをドラッグすると離れます</translation>
        </message>
        <message>
            <source>Duplicate</source>
            <translation>複製</translation>
        </message>
        <message>
            <source>Mirror left and right</source>
            <translation>左右にミラー</translation>
        </message>
        <message>
            <source>“%1”, one of %2 ends here · Tab or a second click: the next</source>
            <comment>the end of a bone</comment>
            <translation>「%1」(ここにある %2 個の端のひとつ)· Tab またはもう一度クリック：次へ</translation>
        </message>
    </context>
    <context>
        <name>imomushi::AccuracyPanel</name>
        <message>
            <source>What accuracy costs</source>
            <translation>精度にかかる時間</translation>
        </message>
        <message>
            <source>faster</source>
            <translation>速い</translation>
        </message>
        <message>
            <source>more accurate</source>
            <translation>正確</translation>
        </message>
        <message>
            <source>From faster to more accurate, along the best settings</source>
            <translation>最良の線に沿って、速いものから正確なものへ</translation>
        </message>
        <message>
            <source>Use this setting</source>
            <translation>この設定を使う</translation>
        </message>
        <message>
            <source>Sets basis, solver meshes, number format and smooth joints of the character, as one step that can be undone</source>
            <translation>キャラクターの基底、計算用メッシュ、数値形式、滑らかな関節をまとめて設定します。1 回で元に戻せます</translation>
        </message>
        <message>
            <source>Budget</source>
            <translation>予算</translation>
        </message>
        <message>
            <source>Budget per frame</source>
            <translation>1 フレームの予算</translation>
        </message>
        <message>
            <source>At 60 frames per second a frame has 16.7 ms for everything</source>
            <translation>毎秒 60 フレームでは、プログラム全体で 1 フレームに 16.7 ms を使えます</translation>
        </message>
        <message>
            <source>Choose</source>
            <translation>選ぶ</translation>
        </message>
        <message>
            <source>Progress of the measurements</source>
            <translation>測定の進み具合</translation>
        </message>
        <message>
            <source>Error against time per frame</source>
            <translation>フレーム時間と誤差</translation>
        </message>
        <message>
            <source>ms per frame</source>
            <translation>1 フレームの ms</translation>
        </message>
        <message>
            <source>error, %</source>
            <translation>誤差 %</translation>
        </message>
        <message>
            <source>Error against precompute</source>
            <translation>前計算と誤差</translation>
        </message>
        <message>
            <source>s of precompute</source>
            <translation>前計算の秒数</translation>
        </message>
        <message>
            <source>Table</source>
            <translation>表</translation>
        </message>
        <message>
            <source>Error on the body</source>
            <translation>体の上の誤差</translation>
        </message>
        <message>
            <source>Cost of a frame</source>
            <translation>フレームの内訳</translation>
        </message>
        <message>
            <source>Measured settings</source>
            <translation>測定した設定</translation>
        </message>
        <message>
            <source>Frame</source>
            <translation>フレーム</translation>
        </message>
        <message>
            <source>error %1 (largest %2 of the diagonal)</source>
            <translation>誤差 %1（最大は対角線の %2）</translation>
        </message>
        <message>
            <source>frame %1 (99 of 100 within %2), predicted %3</source>
            <translation>フレーム %1（100 回中 99 回は %2 以内）、予測 %3</translation>
        </message>
        <message>
            <source>precompute %1, predicted %2</source>
            <translation>前計算 %1、予測 %2</translation>
        </message>
        <message>
            <source>memory of a frame %1</source>
            <translation>フレームのメモリ %1</translation>
        </message>
        <message>
            <source>below the error of the reference itself</source>
            <translation>基準そのものの誤差より小さい値です</translation>
        </message>
        <message>
            <source>the present setting</source>
            <translation>現在の設定</translation>
        </message>
        <message>
            <source>Stop</source>
            <translation>止める</translation>
        </message>
        <message>
            <source>Measured</source>
            <translation>測定済み</translation>
        </message>
        <message>
            <source>Measure</source>
            <translation>測定する</translation>
        </message>
        <message>
            <source>%1 of %2 settings measured · about %3 left</source>
            <translation>%2 設定中 %1 を測定 · 残り約 %3</translation>
        </message>
        <message>
            <source>%1 of %2 settings measured</source>
            <translation>%2 設定中 %1 を測定</translation>
        </message>
        <message>
            <source>%1 of %2 settings measured on this machine</source>
            <translation>このコンピューターで %2 設定中 %1 を測定済み</translation>
        </message>
        <message>
            <source>The character changed since this was measured.</source>
            <translation>測定した後でキャラクターが変わりました。</translation>
        </message>
        <message>
            <source>Not measured yet: it takes some minutes in the background, and can be stopped and continued.</source>
            <translation>まだ測定していません。裏で数分かかり、途中で止めて続けることもできます。</translation>
        </message>
        <message>
            <source>Errors are measured against the full solution on the mesh “%1”. Its own error is %2 (largest %3), and %4 at joint faces.</source>
            <translation>誤差はメッシュ「%1」での完全な解との差です。その解自身の誤差は %2（最大 %3）、関節面によるものは %4 です。</translation>
        </message>
        <message>
            <source>unknown</source>
            <translation>不明</translation>
        </message>
        <message>
            <source>Best within the budget: %1</source>
            <translation>予算内の最良：%1</translation>
        </message>
        <message>
            <source>No measured setting is within the budget.</source>
            <translation>測定した設定で予算に収まるものはありません。</translation>
        </message>
        <message>
            <source>%1 per frame (prediction off by × %2), %3 of precompute</source>
            <translation>1 フレーム %1（予測とのずれ × %2）、前計算 %3</translation>
        </message>
        <message>
            <source>predicted: %1 per frame, %2 of precompute</source>
            <translation>予測：1 フレーム %1、前計算 %2</translation>
        </message>
        <message>
            <source>Cost of effects</source>
            <translation>エフェクトの負荷</translation>
        </message>
        <message>
            <source>Body</source>
            <translation>体</translation>
        </message>
        <message>
            <source>Effects</source>
            <translation>エフェクト</translation>
        </message>
        <message>
            <source>not worth choosing: another setting is at least as good in everything</source>
            <translation>選ぶ価値なし：すべての点で同等以上の設定があります</translation>
        </message>
    </context>
    <context>
        <name>imomushi::AccuracyTable</name>
        <message>
            <source>Measured settings</source>
            <translation>測定した設定</translation>
        </message>
        <message>
            <source>Setting</source>
            <translation>設定</translation>
        </message>
        <message>
            <source>Error</source>
            <translation>誤差</translation>
        </message>
        <message>
            <source>Largest</source>
            <translation>最大</translation>
        </message>
        <message>
            <source>Frame</source>
            <translation>フレーム</translation>
        </message>
        <message>
            <source>Predicted</source>
            <translation>予測</translation>
        </message>
        <message>
            <source>Precompute</source>
            <translation>前計算</translation>
        </message>
        <message>
            <source>Memory</source>
            <translation>メモリ</translation>
        </message>
    </context>
    <context>
        <name>imomushi::EffectCostTable</name>
        <message>
            <source>Cost of effects</source>
            <translation>エフェクトの負荷</translation>
        </message>
        <message>
            <source>Effect</source>
            <translation>エフェクト</translation>
        </message>
        <message>
            <source>Predicted</source>
            <translation>予測</translation>
        </message>
        <message>
            <source>Measured</source>
            <translation>測定済み</translation>
        </message>
        <message>
            <source>Off by</source>
            <translation>予測との差</translation>
        </message>
        <message>
            <source>Fingers need their own precompute: turn touch on, precompute, and measure again.</source>
            <translation>指には専用の前計算が必要です。タッチを有効にして前計算し、もう一度測ってください。</translation>
        </message>
        <message>
            <source>unknown</source>
            <translation>不明</translation>
        </message>
    </context>
    <context>
        <name>imomushi::CostBar</name>
        <message>
            <source>What a frame costs (click for more)</source>
            <translation>1 フレームの内訳（クリックで詳細）</translation>
        </message>
    </context>
    <context>
        <name>imomushi::CostList</name>
        <message>
            <source>Of it, by effect</source>
            <translation>うちエフェクトごと</translation>
        </message>
        <message>
            <source>predicted %1, off by × %2</source>
            <translation>予測 %1、ずれ × %2</translation>
        </message>
        <message>
            <source>predicted %1</source>
            <translation>予測 %1</translation>
        </message>
    </context>
    <context>
        <name>imomushi::FrameCostMeter</name>
        <message>
            <source>Bones (inverse kinematics)</source>
            <translation>ボーン（IK）</translation>
        </message>
        <message>
            <source>Joints</source>
            <translation>関節</translation>
        </message>
        <message>
            <source>Equilibrium of joints</source>
            <translation>関節の釣り合い</translation>
        </message>
        <message>
            <source>Surfaces (product)</source>
            <translation>表面（積）</translation>
        </message>
        <message>
            <source>Normals</source>
            <translation>法線</translation>
        </message>
        <message>
            <source>Upload</source>
            <translation>転送</translation>
        </message>
        <message>
            <source>Drawing</source>
            <translation>描画</translation>
        </message>
    </context>
    <context>
        <name>imomushi::settingText</name>
        <message>
            <source>own meshes</source>
            <translation>要素ごとのメッシュ</translation>
        </message>
        <message>
            <source>mesh as it is</source>
            <translation>元のメッシュ</translation>
        </message>
        <message>
            <source>refined × %1</source>
            <translation>細分 × %1</translation>
        </message>
        <message>
            <source>decimated × %1</source>
            <translation>間引き × %1</translation>
        </message>
        <message>
            <source>best mesh</source>
            <translation>最良メッシュ</translation>
        </message>
        <message>
            <source>default mesh</source>
            <translation>標準メッシュ</translation>
        </message>
        <message>
            <source>previous model</source>
            <translation>従来モデル</translation>
        </message>
        <message>
            <source>paper</source>
            <translation>論文</translation>
        </message>
        <message>
            <source>affine</source>
            <translation>アフィン</translation>
        </message>
        <message>
            <source>full</source>
            <translation>完全</translation>
        </message>
        <message>
            <source>%1, smooth joints</source>
            <translation>%1、滑らかな関節</translation>
        </message>
        <message>
            <source>draft mesh</source>
            <translation>下書きのメッシュ</translation>
        </message>
        <message>
            <source>volume</source>
            <translation>体積（有限要素）</translation>
        </message>
        <message>
            <source>volume × %1</source>
            <translation>体積（有限要素） × %1</translation>
        </message>
        <message>
            <source>%1 shapes</source>
            <translation>形 %1</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ExportDialog</name>
        <message>
            <source>Exact</source>
            <translation>正確</translation>
        </message>
        <message>
            <source>%1 frames/s</source>
            <translation>%1 フレーム/秒</translation>
        </message>
        <message numerus="yes">
            <source>%n target(s)</source>
            <translation>
                <numerusform>ターゲット %n 個</numerusform>
            </translation>
        </message>
        <message>
            <source>weights 0–1</source>
            <translation>ウェイト 0〜1</translation>
        </message>
        <message>
            <source>16 bits</source>
            <translation>16 ビット</translation>
        </message>
        <message>
            <source>All targets, keys as recorded</source>
            <translation>全ターゲット、記録どおりのキー</translation>
        </message>
        <message>
            <source>Export</source>
            <translation>書き出し</translation>
        </message>
        <message>
            <source>Baked</source>
            <translation>ベイク</translation>
        </message>
        <message>
            <source>Rigged</source>
            <translation>リグ</translation>
        </message>
        <message>
            <source>A skeleton that drives morph targets: for live puppeteering</source>
            <translation>モーフターゲットを駆動する骨格：その場で操れます</translation>
        </message>
        <message>
            <source>Skinned</source>
            <translation>スキン</translation>
        </message>
        <message>
            <source>Fitted weights, no morph targets: for any engine</source>
            <translation>近似ウェイト、モーフなし：どのエンジンでも</translation>
        </message>
        <message>
            <source>Cache</source>
            <translation>キャッシュ</translation>
        </message>
        <message>
            <source>Every vertex in every frame: everything, but large</source>
            <translation>全フレームの全頂点：すべて入るが大きい</translation>
        </message>
        <message>
            <source>%1 per second</source>
            <translation>毎秒 %1</translation>
        </message>
        <message>
            <source>As recorded</source>
            <translation>記録どおり</translation>
        </message>
        <message numerus="yes">
            <source>The %n most important of each element or character</source>
            <translation>
                <numerusform>各要素またはキャラクターの重要な %n 個</numerusform>
            </translation>
        </message>
        <message>
            <source>All</source>
            <translation>すべて</translation>
        </message>
        <message>
            <source>OBJ, a file per frame</source>
            <translation>OBJ（フレームごとに 1 ファイル）</translation>
        </message>
        <message>
            <source>PLY, a file per frame</source>
            <translation>PLY（フレームごとに 1 ファイル）</translation>
        </message>
        <message>
            <source>Weights within 0 and 1</source>
            <translation>ウェイトを 0〜1 に収める</translation>
        </message>
        <message>
            <source>A target for each sign of a weight, for programs that clamp weights: twice as many targets</source>
            <translation>ウェイトを切り詰めるプログラムのため、正負ごとにターゲットを分けます。ターゲットの数は 2 倍になります</translation>
        </message>
        <message>
            <source>16 bits per coordinate</source>
            <translation>座標を 16 ビットにする</translation>
        </message>
        <message>
            <source>Smaller files by KHR_mesh_quantization; what that costs is measured</source>
            <translation>KHR_mesh_quantization でファイルを小さくします。誤差は測って示します</translation>
        </message>
        <message>
            <source>Compressed by meshopt</source>
            <translation>meshopt で圧縮する</translation>
        </message>
        <message>
            <source>Smaller files by EXT_meshopt_compression, without loss; programs must know it: three.js and Babylon.js do, Blender does not</source>
            <translation>EXT_meshopt_compression で、何も失わずにファイルを小さくします。読めるのはこれを知るプログラムだけです。three.js と Babylon.js は読め、Blender は読めません</translation>
        </message>
        <message>
            <source>Targets move normals</source>
            <translation>ターゲットで法線も動かす</translation>
        </message>
        <message>
            <source>For engines that do not find normals themselves: larger files</source>
            <translation>法線を自分で求めないエンジン向け。ファイルは大きくなります</translation>
        </message>
        <message>
            <source>Take</source>
            <translation>テイク</translation>
        </message>
        <message>
            <source>Keys</source>
            <translation>キー</translation>
        </message>
        <message>
            <source>Format</source>
            <translation>形式</translation>
        </message>
        <message>
            <source>Morph targets</source>
            <translation>モーフターゲット</translation>
        </message>
        <message>
            <source>File</source>
            <translation>ファイル</translation>
        </message>
        <message>
            <source>Choose…</source>
            <translation>選ぶ…</translation>
        </message>
        <message>
            <source>For</source>
            <translation>用途</translation>
        </message>
        <message>
            <source>As</source>
            <translation>方式</translation>
        </message>
        <message>
            <source>character</source>
            <translation>キャラクター</translation>
        </message>
        <message>
            <source>The pose as it is: there are no takes</source>
            <translation>今のポーズ（テイクなし）</translation>
        </message>
        <message>
            <source>All takes (%1)</source>
            <translation>すべてのテイク（%1）</translation>
        </message>
        <message>
            <source>Replaces the file that is there.</source>
            <translation>今あるファイルを置き換えます。</translation>
        </message>
        <message>
            <source>Export to</source>
            <translation>書き出し先</translation>
        </message>
        <message>
            <source>Cancel</source>
            <translation>中止</translation>
        </message>
        <message>
            <source>Close</source>
            <translation>閉じる</translation>
        </message>
        <message>
            <source>, </source>
            <translation>、</translation>
        </message>
        <message>
            <source>Rigid motion and morphs: exact, plays anywhere</source>
            <translation>剛体運動とモーフ：正確で、どこでも再生</translation>
        </message>
        <message>
            <source>FBX, by Blender</source>
            <translation>FBX（Blender で作成）</translation>
        </message>
        <message>
            <source>All takes (%1) and the pose as it is</source>
            <translation>すべてのテイク (%1) と今のポーズ</translation>
        </message>
        <message>
            <source>The pose as it is</source>
            <translation>今のポーズ</translation>
        </message>
        <message>
            <source>VRM 1.0 avatar</source>
            <translation>VRM 1.0 アバター</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ExportReportView</name>
        <message>
            <source>Show in folder</source>
            <translation>フォルダーで表示</translation>
        </message>
        <message>
            <source>Nothing written yet</source>
            <translation>まだ書き出していません</translation>
        </message>
        <message>
            <source>This character has effects: %1. The report says what the file keeps of each.</source>
            <translation>このキャラクターのエフェクト：%1。それぞれがファイルにどう残るかを、ここに示します。</translation>
        </message>
        <message>
            <source>, </source>
            <translation>、</translation>
        </message>
        <message>
            <source>The written file is read back and compared with the character.</source>
            <translation>書き出したファイルは読み戻し、キャラクターと比べます。</translation>
        </message>
        <message>
            <source>Writing %1</source>
            <translation>%1 を書き出し中</translation>
        </message>
        <message>
            <source>Cancelled: nothing was written.</source>
            <translation>中止しました。何も書き出していません。</translation>
        </message>
        <message>
            <source>It could not be exported.</source>
            <translation>書き出せませんでした。</translation>
        </message>
        <message>
            <source>Wrote %1, %2</source>
            <translation>%1 を書き出しました（%2）</translation>
        </message>
        <message numerus="yes">
            <source>Wrote %n file(s) from %1 on, %2</source>
            <translation>
                <numerusform>%1 から %n 個のファイルを書き出しました（%2）</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>Read back and compared in %n frame(s): off by %1 of the diagonal at most</source>
            <translation>
                <numerusform>読み戻して %n フレームで比較：ずれは最大で対角線の %1</numerusform>
            </translation>
        </message>
        <message>
            <source>Written as the mesh of its file: %1</source>
            <translation>元のファイルのメッシュとして書き出しました：%1</translation>
        </message>
        <message>
            <source>Surface beside joints and attached parts: off by %1 at most</source>
            <translation>関節のそばの表面と取り付けた部品：ずれは最大 %1</translation>
        </message>
        <message>
            <source>The skin is fitted: off by %1 at most</source>
            <translation>スキンは近似です：ずれは最大 %1</translation>
        </message>
        <message>
            <source>16 bits: off by %1 at most</source>
            <translation>16 ビット：ずれは最大 %1</translation>
        </message>
        <message>
            <source>Compressed without loss: %1 before</source>
            <translation>何も失わずに圧縮しました。圧縮前は %1</translation>
        </message>
        <message>
            <source>Targets left out: off by %1 at most</source>
            <translation>省いたターゲット：ずれは最大 %1</translation>
        </message>
        <message>
            <source>%1 vertices</source>
            <translation>%1 頂点</translation>
        </message>
        <message>
            <source>%1 targets</source>
            <translation>ターゲット %1 個</translation>
        </message>
        <message>
            <source>%1 keys</source>
            <translation>キー %1 個</translation>
        </message>
        <message>
            <source>%1: exact</source>
            <translation>%1：正確</translation>
        </message>
        <message>
            <source>%1: fitted, off by %2 at most</source>
            <translation>%1：近似、ずれは最大 %2</translation>
        </message>
        <message>
            <source>%1: left out</source>
            <translation>%1：含まれません</translation>
        </message>
    </context>
    <context>
        <name>imomushi::TakeDeck</name>
        <message>
            <source>Take %1</source>
            <translation>テイク %1</translation>
        </message>
        <message>
            <source>The recording ended early: the character changed meanwhile, or the take was full.</source>
            <translation>記録は途中で終わりました。記録中にキャラクターが変わったか、テイクがいっぱいになりました。</translation>
        </message>
        <message>
            <source>%1 copy</source>
            <comment>name of a take</comment>
            <translation>%1 のコピー</translation>
        </message>
        <message>
            <source>%1 copy %2</source>
            <comment>name of a take</comment>
            <translation>%1 のコピー %2</translation>
        </message>
        <message numerus="yes">
            <source>%n element(s) play as drafts: precompute them (P) for what their settings ask for.</source>
            <translation>
                <numerusform>%n 個の要素は下書きのまま再生されます。設定どおりにするには前計算してください（P）。</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::TakeModel</name>
        <message numerus="yes">
            <source>%1 s · %n frame(s)</source>
            <comment>length of a take</comment>
            <translation>
                <numerusform>%1 秒 · %n フレーム</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::TakesPanel</name>
        <message>
            <source>Stop</source>
            <comment>recording, where there is little room</comment>
            <translation>止める</translation>
        </message>
        <message>
            <source>Stop recording</source>
            <translation>記録を止める</translation>
        </message>
        <message>
            <source>Record</source>
            <translation>記録</translation>
        </message>
        <message>
            <source>No takes yet. Press Record and drag the character: all that you see is kept, until you press it again.</source>
            <translation>まだテイクがありません。「記録」を押してキャラクターをドラッグすると、もう一度押すまで、見えたものがすべて残ります。</translation>
        </message>
        <message>
            <source>What you perform is recorded here. Open a sample or import a mesh first.</source>
            <translation>演技はここに記録されます。先にサンプルを開くか、メッシュを読み込んでください。</translation>
        </message>
        <message>
            <source>%1 · %2 · frame %3</source>
            <comment>take, time, frame</comment>
            <translation>%1 · %2 · フレーム %3</translation>
        </message>
        <message>
            <source>%1 / %2 · frame %3 of %4</source>
            <comment>time, length, frame, frames</comment>
            <translation>%1 / %2 · フレーム %3 / %4</translation>
        </message>
        <message>
            <source>The character has changed since the recording. The take shows its poses, without effects.</source>
            <translation>記録した後にキャラクターが変わりました。テイクは、エフェクトを除いたポーズだけを示します。</translation>
        </message>
        <message>
            <source>Takes</source>
            <translation>テイク</translation>
        </message>
        <message>
            <source>Time</source>
            <translation>時間</translation>
        </message>
        <message>
            <source>Starts in %1 s – stop</source>
            <comment>a recording</comment>
            <translation>%1 秒後に開始 – 中止</translation>
        </message>
        <message>
            <source>Drag to any moment; arrow keys go frame by frame. The marks below say which part is played, and which part trimming keeps.</source>
            <translation>ドラッグで好きな瞬間を表示。矢印キーで 1 フレームずつ進みます。下の目印は、再生し、切り詰めで残す範囲です。</translation>
        </message>
        <message>
            <source>Recorded on another version: pose only</source>
            <translation>別の版で記録：ポーズのみ</translation>
        </message>
    </context>
    <context>
        <name>imomushi::TimeBar</name>
        <message>
            <source>%1 s</source>
            <translation>%1 秒</translation>
        </message>
    </context>
    <context>
        <name>imomushi::AccuracyErrors</name>
        <message>
            <source>Pose</source>
            <translation>ポーズ</translation>
        </message>
        <message>
            <source>As it is set now, error in colours</source>
            <translation>今の設定（色は誤差）</translation>
        </message>
        <message>
            <source>Full solution</source>
            <translation>完全な解</translation>
        </message>
        <message>
            <source>% of the diagonal</source>
            <translation>%（対角線比）</translation>
        </message>
        <message>
            <source>stretch</source>
            <translation>伸び</translation>
        </message>
        <message>
            <source>bend</source>
            <translation>曲げ</translation>
        </message>
        <message>
            <source>twist</source>
            <translation>ねじり</translation>
        </message>
        <message>
            <source>random 1</source>
            <translation>ランダム 1</translation>
        </message>
        <message>
            <source>random 2</source>
            <translation>ランダム 2</translation>
        </message>
        <message>
            <source>random 3</source>
            <translation>ランダム 3</translation>
        </message>
        <message>
            <source>error %1 (largest %2 of the diagonal)</source>
            <translation>誤差 %1（最大は対角線の %2）</translation>
        </message>
        <message>
            <source>the pose of now</source>
            <translation>今のポーズ</translation>
        </message>
        <message>
            <source>Stop</source>
            <translation>止める</translation>
        </message>
        <message>
            <source>Measure</source>
            <translation>測定する</translation>
        </message>
        <message>
            <source>%1 · about %2 left</source>
            <translation>%1 · 残り約 %2</translation>
        </message>
        <message>
            <source>the character has moved or changed since</source>
            <translation>その後キャラクターが動いたか、変わっています</translation>
        </message>
        <message>
            <source>The full solution takes about %1 and %2, once, in the background; then every pose takes a moment.</source>
            <translation>完全解には最初の一度だけ約 %1 と %2 が必要です（作業は続けられます）。その後はどのポーズもすぐに測れます。</translation>
        </message>
        <message>
            <source>full solution itself %1</source>
            <translation>完全解自体の誤差 %1</translation>
        </message>
        <message>
            <source>The full solution took %1 and keeps %2; this pose took %3.</source>
            <translation>完全解には %1 かかり、%2 を保持しています。このポーズには %3 かかりました。</translation>
        </message>
        <message>
            <source>unknown</source>
            <translation>不明</translation>
        </message>
    </context>
    <context>
        <name>BodyTexts</name>
        <message>
            <source>exact</source>
            <translation>そのまま</translation>
        </message>
        <message>
            <source>mended</source>
            <translation>修復</translation>
        </message>
        <message>
            <source>wrapped</source>
            <translation>包み直し</translation>
        </message>
        <message>
            <source>automatic</source>
            <translation>自動</translation>
        </message>
        <message>
            <source>%1 % of the diagonal</source>
            <translation>対角線の %1 %</translation>
        </message>
        <message>
            <source>Body: %1 vertices, %2 triangles</source>
            <translation>ボディ：頂点 %1、三角形 %2</translation>
        </message>
        <message>
            <source>Distance %1, largest %2</source>
            <translation>距離 %1、最大 %2</translation>
        </message>
        <message>
            <source>Volume error %1 %</source>
            <translation>体積の誤差 %1 %</translation>
        </message>
        <message numerus="yes">
            <source>%n link(s) of flesh, %1 % of the volume</source>
            <translation>
                <numerusform>肉のつなぎ %n か所（体積の %1 %）</numerusform>
            </translation>
        </message>
        <message numerus="yes">
            <source>%n gap(s) closed, %1 % of the surface</source>
            <translation>
                <numerusform>%n か所のすき間を閉じました（表面の %1 %）</numerusform>
            </translation>
        </message>
        <message>
            <source>Weld</source>
            <comment>vertices</comment>
            <translation>結合</translation>
        </message>
        <message>
            <source>Drop</source>
            <comment>triangles without area, copies, unused vertices</comment>
            <translation>除去</translation>
        </message>
        <message>
            <source>Separate</source>
            <comment>surfaces that touch</comment>
            <translation>分離</translation>
        </message>
        <message>
            <source>Orient</source>
            <comment>triangles alike and outward</comment>
            <translation>向きを揃える</translation>
        </message>
        <message>
            <source>Fill</source>
            <comment>holes</comment>
            <translation>穴埋め</translation>
        </message>
        <message>
            <source>Wrap</source>
            <comment>a new surface around everything</comment>
            <translation>包み直す</translation>
        </message>
    </context>
    <context>
        <name>imomushi::CutForm</name>
        <message>
            <source>Cut</source>
            <translation>切断面</translation>
        </message>
        <message>
            <source>Character</source>
            <translation>キャラクター</translation>
        </message>
        <message>
            <source>Behind it</source>
            <translation>後ろ側</translation>
        </message>
        <message>
            <source>In front</source>
            <translation>前側</translation>
        </message>
        <message>
            <source>Remove the cut</source>
            <translation>切断面を取り除く</translation>
        </message>
        <message>
            <source>%1 · out of date</source>
            <translation>%1 · 古くなっています</translation>
        </message>
        <message>
            <source>%1 · not precomputed</source>
            <translation>%1 · 前計算なし</translation>
        </message>
        <message>
            <source>Origin at rest</source>
            <translation>原点（静止時）</translation>
        </message>
        <message>
            <source>Normal at rest</source>
            <translation>法線（静止時）</translation>
        </message>
    </context>
    <context>
        <name>imomushi::WholeCharacterForm</name>
        <message>
            <source>Character</source>
            <translation>キャラクター</translation>
        </message>
        <message>
            <source>Contents</source>
            <translation>内容</translation>
        </message>
        <message>
            <source>Parts</source>
            <translation>部分</translation>
        </message>
        <message>
            <source>Vertices</source>
            <translation>頂点</translation>
        </message>
        <message>
            <source>Triangles</source>
            <translation>三角形</translation>
        </message>
        <message>
            <source>Elements</source>
            <translation>要素</translation>
        </message>
        <message>
            <source>Cuts</source>
            <translation>切断面</translation>
        </message>
        <message>
            <source>none</source>
            <translation>なし</translation>
        </message>
        <message>
            <source>Body</source>
            <translation>ボディ</translation>
        </message>
        <message>
            <source>Made</source>
            <translation>作り方</translation>
        </message>
        <message>
            <source>%1 (%2)</source>
            <translation>%1（%2）</translation>
        </message>
        <message>
            <source>Distance</source>
            <translation>距離</translation>
        </message>
        <message>
            <source>Largest distance</source>
            <translation>最大の距離</translation>
        </message>
        <message>
            <source>Volume error</source>
            <translation>体積の誤差</translation>
        </message>
        <message>
            <source>unknown: the mesh encloses none</source>
            <translation>不明：メッシュが体積を囲んでいません</translation>
        </message>
        <message>
            <source>%1 %</source>
            <translation>%1 %</translation>
        </message>
        <message>
            <source>Detail</source>
            <translation>細かさ</translation>
        </message>
        <message>
            <source>Separate surfaces</source>
            <translation>離れた面</translation>
        </message>
        <message>
            <source>Gaps that the body closes</source>
            <translation>ボディが閉じるすき間</translation>
        </message>
        <message>
            <source>Walls</source>
            <translation>壁</translation>
        </message>
        <message>
            <source>%1 % of the surface</source>
            <translation>表面の %1 %</translation>
        </message>
        <message>
            <source>Width</source>
            <translation>幅</translation>
        </message>
        <message>
            <source>%1 to %2</source>
            <translation>%1 ～ %2</translation>
        </message>
        <message>
            <source>Show</source>
            <translation>表示</translation>
        </message>
        <message>
            <source>Place %1</source>
            <translation>場所 %1</translation>
        </message>
        <message>
            <source>More</source>
            <translation>ほか</translation>
        </message>
        <message numerus="yes">
            <source>%n more in the list of issues</source>
            <translation>
                <numerusform>ほか %n 件は問題の一覧にあります</numerusform>
            </translation>
        </message>
        <message>
            <source>Morph targets</source>
            <translation>モーフターゲット</translation>
        </message>
        <message>
            <source>How parts follow</source>
            <translation>部分の従い方</translation>
        </message>
        <message>
            <source>choose one</source>
            <translation>選んでください</translation>
        </message>
        <message>
            <source>Part</source>
            <translation>部分</translation>
        </message>
        <message>
            <source>Follows</source>
            <translation>従い方</translation>
        </message>
        <message>
            <source>by itself</source>
            <translation>自動</translation>
        </message>
        <message>
            <source>as flesh</source>
            <translation>肉として</translation>
        </message>
        <message>
            <source>rigidly</source>
            <translation>剛体として</translation>
        </message>
        <message>
            <source>nearest</source>
            <translation>最も近いもの</translation>
        </message>
        <message>
            <source>Element</source>
            <translation>要素</translation>
        </message>
        <message>
            <source>Pivot at rest</source>
            <translation>静止時の回転中心</translation>
        </message>
        <message>
            <source>Middle of the part</source>
            <translation>部分の中心</translation>
        </message>
        <message>
            <source>Place at</source>
            <translation>置く場所</translation>
        </message>
        <message>
            <source>Turn about the pivot</source>
            <translation>中心まわりの回転</translation>
        </message>
        <message>
            <source>About %1</source>
            <translation>%1 軸まわり</translation>
        </message>
        <message>
            <source>Avatar (VRM %1)</source>
            <translation>アバター (VRM %1)</translation>
        </message>
        <message>
            <source>Expression</source>
            <translation>表情</translation>
        </message>
        <message>
            <source>Humanoid bones</source>
            <translation>人型ボーン</translation>
        </message>
        <message>
            <source>Springs</source>
            <translation>揺れもの</translation>
        </message>
        <message numerus="yes">
            <source>%n, kept for export</source>
            <translation>
                <numerusform>%n 個 (書き出し用に保持)</numerusform>
            </translation>
        </message>
        <message>
            <source>Licence of the avatar</source>
            <translation>アバターのライセンス</translation>
        </message>
    </context>
    <context>
        <name>imomushi::LinksDialog</name>
        <message>
            <source>Links of flesh</source>
            <translation>肉のつなぎ</translation>
        </message>
        <message>
            <source>A link is a tube of flesh between two parts that do not touch, so that the body hangs together. Without its link a small part is carried by the body, and a large one hangs on nothing.</source>
            <translation>つなぎは、触れていない二つの部分のあいだの肉の管です。これで体が一つにつながります。つなぎがないと、小さな部分は体が運び、大きな部分は何にもつながりません。</translation>
        </message>
        <message>
            <source>Between</source>
            <translation>どこの間</translation>
        </message>
        <message>
            <source>Radius</source>
            <translation>半径</translation>
        </message>
        <message>
            <source>Volume</source>
            <translation>体積</translation>
        </message>
        <message>
            <source>%1 and %2</source>
            <translation>%1 と %2</translation>
        </message>
        <message>
            <source>not made</source>
            <translation>作られなかった</translation>
        </message>
        <message>
            <source>%1 %</source>
            <translation>%1 %</translation>
        </message>
        <message>
            <source>As found</source>
            <translation>見つけたとおり</translation>
        </message>
        <message>
            <source>Use these links</source>
            <translation>このつなぎを使う</translation>
        </message>
    </context>
    <context>
        <name>imomushi::BonesDialog</name>
        <message>
            <source>Bones of the skeleton</source>
            <translation>骨格のボーン</translation>
        </message>
        <message>
            <source>Checked bones stay and get flesh of their own. All others are merged: what carries them moves their flesh. Few bones make few elements, which are quick and soft.</source>
            <translation>チェックしたボーンは残り、自分の肉を持ちます。ほかのボーンは統合され、その肉は親のボーンが動かします。ボーンが少ないほど要素も少なく、速く柔らかくなります。</translation>
        </message>
        <message>
            <source>Bone</source>
            <translation>ボーン</translation>
        </message>
        <message>
            <source>Flesh</source>
            <translation>肉</translation>
        </message>
        <message>
            <source>What becomes of it</source>
            <translation>どうなるか</translation>
        </message>
        <message>
            <source>%1 %</source>
            <translation>%1 %</translation>
        </message>
        <message>
            <source>none</source>
            <comment>flesh</comment>
            <translation>なし</translation>
        </message>
        <message>
            <source>Check all</source>
            <translation>すべてチェック</translation>
        </message>
        <message>
            <source>Check none</source>
            <translation>チェックを外す</translation>
        </message>
        <message>
            <source>As proposed</source>
            <translation>提案どおり</translation>
        </message>
        <message>
            <source>Use these bones</source>
            <translation>このボーンを使う</translation>
        </message>
        <message>
            <source>stays</source>
            <translation>残る</translation>
        </message>
        <message>
            <source>merged</source>
            <translation>統合</translation>
        </message>
        <message>
            <source>merged into %1</source>
            <translation>%1 に統合</translation>
        </message>
        <message>
            <source>%1 of %2 bones stay</source>
            <translation>%2 本中 %1 本のボーンが残ります</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ClipsDialog</name>
        <message>
            <source>Takes from clips</source>
            <translation>クリップからテイクを作る</translation>
        </message>
        <message>
            <source>Clips of the file of “%1”. A take of one moves the bones as the file does, and the flesh with them.</source>
            <translation>「%1」のファイルにあるクリップです。テイクにすると、ファイルと同じようにボーンが動き、肉もついてきます。</translation>
        </message>
        <message>
            <source>Clips</source>
            <translation>クリップ</translation>
        </message>
        <message>
            <source>%1 · %2</source>
            <comment>clip, its length</comment>
            <translation>%1 · %2</translation>
        </message>
        <message>
            <source>Check all</source>
            <translation>すべてチェック</translation>
        </message>
        <message>
            <source>Make takes</source>
            <translation>テイクを作る</translation>
        </message>
    </context>
    <context>
        <name>imomushi::NextSteps</name>
        <message>
            <source>Drop a mesh or a project here</source>
            <translation>ここにメッシュかプロジェクトをドロップ</translation>
        </message>
        <message>
            <source>Any mesh can become a soft character: OBJ, PLY, STL, glTF, FBX, DAE.</source>
            <translation>どんなメッシュも柔らかいキャラクターになります（OBJ、PLY、STL、glTF、FBX、DAE）。</translation>
        </message>
        <message>
            <source>Import a mesh…</source>
            <translation>メッシュを読み込む…</translation>
        </message>
        <message>
            <source>Open a sample</source>
            <translation>サンプルを開く</translation>
        </message>
        <message>
            <source>Open a project…</source>
            <translation>プロジェクトを開く…</translation>
        </message>
        <message>
            <source>“%1” is not soft yet.</source>
            <translation>「%1」はまだ柔らかくありません。</translation>
        </message>
        <message>
            <source>Make it soft</source>
            <translation>柔らかくする</translation>
        </message>
        <message>
            <source>Place a handle</source>
            <translation>ハンドルを置く</translation>
        </message>
        <message>
            <source>Cut it</source>
            <translation>切断する</translation>
        </message>
        <message>
            <source>“%1” has nothing to be moved by yet.</source>
            <translation>「%1」にはまだ動かすものがありません。</translation>
        </message>
        <message>
            <source>Place a joint face</source>
            <translation>関節面を置く</translation>
        </message>
        <message>
            <source>Bones move joint faces.</source>
            <translation>関節面はボーンで動きます。</translation>
        </message>
        <message>
            <source>Place bones</source>
            <translation>ボーンを置く</translation>
        </message>
        <message>
            <source>Close</source>
            <translation>閉じる</translation>
        </message>
    </context>
    <context>
        <name>imomushi::RigFlow</name>
        <message>
            <source>Making a take of “%1”</source>
            <translation>「%1」のテイクを作っています</translation>
        </message>
        <message numerus="yes">
            <source>Made %n take(s). The space bar plays the chosen one.</source>
            <translation>
                <numerusform>テイクを %n 個作りました。スペースキーで選んだテイクを再生します。</numerusform>
            </translation>
        </message>
    </context>
    <context>
        <name>imomushi::PictureDialog</name>
        <message>
            <source>Save a picture</source>
            <translation>画像を保存</translation>
        </message>
        <message>
            <source> px</source>
            <comment>pixels</comment>
            <translation> px</translation>
        </message>
        <message>
            <source>Width</source>
            <translation>幅</translation>
        </message>
        <message>
            <source>Height</source>
            <translation>高さ</translation>
        </message>
        <message>
            <source>Transparent background</source>
            <translation>背景を透明にする</translation>
        </message>
        <message>
            <source>Ground and its shadow</source>
            <translation>地面と影</translation>
        </message>
        <message>
            <source>Bones and handles, where they are shown</source>
            <translation>表示しているボーンとハンドル</translation>
        </message>
        <message>
            <source>Save…</source>
            <translation>保存…</translation>
        </message>
    </context>
    <context>
        <name>MappingTexts</name>
        <message>
            <source>mouth “oh”</source>
            <translation>口の形「お」</translation>
        </message>
        <message>
            <source>mouth “ee”</source>
            <translation>口の形「え」</translation>
        </message>
        <message>
            <source>mouth “ou”</source>
            <translation>口の形「う」</translation>
        </message>
        <message>
            <source>mouth “ih”</source>
            <translation>口の形「い」</translation>
        </message>
        <message>
            <source>mouth “aa”</source>
            <translation>口の形「あ」</translation>
        </message>
        <message>
            <source>loudness</source>
            <translation>音量</translation>
        </message>
        <message>
            <source>right shoulder button</source>
            <translation>右ショルダーボタン</translation>
        </message>
        <message>
            <source>left shoulder button</source>
            <translation>左ショルダーボタン</translation>
        </message>
        <message>
            <source>right trigger</source>
            <translation>右トリガー</translation>
        </message>
        <message>
            <source>left trigger</source>
            <translation>左トリガー</translation>
        </message>
        <message>
            <source>right stick ↕</source>
            <translation>右スティック ↕</translation>
        </message>
        <message>
            <source>right stick ↔</source>
            <translation>右スティック ↔</translation>
        </message>
        <message>
            <source>left stick ↕</source>
            <translation>左スティック ↕</translation>
        </message>
        <message>
            <source>left stick ↔</source>
            <translation>左スティック ↔</translation>
        </message>
        <message>
            <source>enter</source>
            <translation>エンター</translation>
        </message>
        <message>
            <source>backspace</source>
            <translation>バックスペース</translation>
        </message>
        <message>
            <source>space bar</source>
            <translation>スペースキー</translation>
        </message>
        <message>
            <source>arrow keys</source>
            <translation>矢印キー</translation>
        </message>
        <message>
            <source>sideways (X)</source>
            <translation>左右 (X)</translation>
        </message>
        <message>
            <source>up (Y)</source>
            <translation>上下 (Y)</translation>
        </message>
        <message>
            <source>forward (Z)</source>
            <translation>前後 (Z)</translation>
        </message>
        <message>
            <source>turn %1</source>
            <comment>about an axis</comment>
            <translation>%1 軸の回転</translation>
        </message>
        <message>
            <source>%1, %2</source>
            <comment>a handle, a number of it</comment>
            <translation>%1、%2</translation>
        </message>
        <message>
            <source>Pose “%1”</source>
            <comment>a kept pose</comment>
            <translation>ポーズ「%1」</translation>
        </message>
        <message>
            <source>Cycle “%1”</source>
            <comment>a movement that repeats</comment>
            <translation>サイクル「%1」</translation>
        </message>
        <message>
            <source>amount</source>
            <comment>of a cycle</comment>
            <translation>量</translation>
        </message>
        <message>
            <source>speed</source>
            <comment>of a cycle</comment>
            <translation>速さ</translation>
        </message>
        <message>
            <source>Cycles</source>
            <translation>サイクル</translation>
        </message>
        <message>
            <source>%1, amount</source>
            <comment>a cycle</comment>
            <translation>%1、量</translation>
        </message>
        <message>
            <source>%1, speed</source>
            <comment>a cycle</comment>
            <translation>%1、速さ</translation>
        </message>
        <message>
            <source>Poses</source>
            <translation>ポーズ</translation>
        </message>
        <message>
            <source>%1 end</source>
            <comment>a bone</comment>
            <translation>%1 の先</translation>
        </message>
        <message>
            <source>%1 start</source>
            <comment>a bone</comment>
            <translation>%1 の根元</translation>
        </message>
        <message>
            <source>roll</source>
            <translation>ひねり</translation>
        </message>
        <message>
            <source>weight</source>
            <translation>重み</translation>
        </message>
        <message>
            <source>%1, %2</source>
            <comment>a control, a number of it</comment>
            <translation>%1、%2</translation>
        </message>
        <message>
            <source>%1, number %2</source>
            <comment>a control</comment>
            <translation>%1、%2 番目の数</translation>
        </message>
        <message>
            <source>Game controller</source>
            <translation>ゲームコントローラー</translation>
        </message>
        <message>
            <source>%1, %2</source>
            <comment>an end of a bone, a direction</comment>
            <translation>%1、%2</translation>
        </message>
        <message>
            <source>end</source>
            <translation>先</translation>
        </message>
        <message>
            <source>start</source>
            <translation>根元</translation>
        </message>
        <message>
            <source>Shapes of %1</source>
            <comment>morph targets of a character</comment>
            <translation>%1 の形</translation>
        </message>
        <message>
            <source>Play “%1”</source>
            <comment>a take</comment>
            <translation>「%1」を再生する</translation>
        </message>
        <message>
            <source>Stop “%1”</source>
            <comment>a take</comment>
            <translation>「%1」を止める</translation>
        </message>
        <message>
            <source>%1 %2</source>
            <comment>a setting of an effect, X, Y or Z</comment>
            <translation>%1 %2</translation>
        </message>
        <message>
            <source>Stop every input</source>
            <translation>全入力を止める</translation>
        </message>
        <message>
            <source>Triggers</source>
            <translation>トリガー</translation>
        </message>
        <message>
            <source>Keyboard</source>
            <translation>キーボード</translation>
        </message>
        <message>
            <source>Microphone</source>
            <translation>マイク</translation>
        </message>
    </context>
    <context>
        <name>imomushi::LearnBar</name>
        <message>
            <source>There is no handle, no bone and no shape that could be driven.</source>
            <translation>動かせるハンドル、ボーン、形がありません。</translation>
        </message>
        <message>
            <source>Press, then move the control that is to drive this.</source>
            <translation>押してから、これを動かす操作子を動かしてください。</translation>
        </message>
        <message>
            <source>Move the control that is to drive “%1” …</source>
            <translation>「%1」を動かす操作子を動かしてください…</translation>
        </message>
        <message>
            <source>%1, from %2 to %3 …</source>
            <comment>a control that moves, its range</comment>
            <translation>%1、%2 から %3 まで…</translation>
        </message>
        <message>
            <source>What is to be driven</source>
            <translation>動かすもの</translation>
        </message>
        <message>
            <source>Which number of it</source>
            <translation>その中のどの数</translation>
        </message>
        <message>
            <source>Learn</source>
            <translation>学習</translation>
        </message>
        <message>
            <source>Use it</source>
            <translation>これを使う</translation>
        </message>
        <message>
            <source>Cancel</source>
            <translation>キャンセル</translation>
        </message>
        <message>
            <source>Plug in a device, or switch on a source first.</source>
            <translation>まず機器をつなぐか、送り手をオンにしてください。</translation>
        </message>
    </context>
    <context>
        <name>imomushi::LivePanel</name>
        <message>
            <source>Inputs are stopped. Press a mapped key or Continue, and they go on.</source>
            <translation>入力は止まっています。割り当てたキーか「続ける」を押すと、また動きます。</translation>
        </message>
        <message>
            <source>What inputs held was undone. They move nothing until you continue.</source>
            <translation>入力が保持していたものを元に戻しました。「続ける」まで、入力は何も動かしません。</translation>
        </message>
        <message>
            <source>Inputs could not take hold of the character. They move nothing until you continue.</source>
            <translation>入力はキャラクターをつかめませんでした。「続ける」まで、何も動かしません。</translation>
        </message>
        <message>
            <source>A take is shown. Press a mapped key or Continue, and inputs move the character.</source>
            <translation>テイクを表示中です。割り当てたキーか「続ける」を押すと、入力がキャラクターを動かします。</translation>
        </message>
        <message>
            <source>There is no character to perform yet. Open a sample, or make a mesh soft.</source>
            <translation>演じるキャラクターがまだありません。サンプルを開くか、メッシュを柔らかくしてください。</translation>
        </message>
        <message>
            <source>Learn: choose what is to move, press Learn, and move a control.</source>
            <translation>学習：動かすものを選び、「学習」を押して、操作子を動かしてください。</translation>
        </message>
        <message>
            <source>Record: all that you see is kept.</source>
            <translation>記録：見えているものがすべて残ります。</translation>
        </message>
        <message>
            <source>Play. Recording keeps what you perform as a take.</source>
            <translation>演じる。記録すると、演技がテイクになります。</translation>
        </message>
        <message>
            <source>Play. %1 records what you perform as a take.</source>
            <comment>a key</comment>
            <translation>演じる。%1 で、演技をテイクに記録します。</translation>
        </message>
        <message>
            <source>Sources</source>
            <translation>送り手</translation>
        </message>
        <message>
            <source>Mappings</source>
            <translation>対応づけ</translation>
        </message>
        <message>
            <source>Move this row up. Of rows that drive the same, the upper one wins.</source>
            <translation>この行を上へ。同じものを動かす行では、上の行が勝ちます。</translation>
        </message>
        <message>
            <source>Move this row down</source>
            <translation>この行を下へ</translation>
        </message>
        <message>
            <source>Remove this row</source>
            <translation>この行を削除</translation>
        </message>
        <message>
            <source>Continue</source>
            <translation>続ける</translation>
        </message>
        <message>
            <source>Stop every input</source>
            <translation>全入力を止める</translation>
        </message>
        <message>
            <source>Everything that inputs move glides to rest, and they move nothing more until you continue.</source>
            <translation>入力が動かしているものはすべて、なめらかに静止の姿へ戻ります。「続ける」まで、入力は何も動かしません。</translation>
        </message>
        <message>
            <source>Plug: nothing has come yet. On the left is what is waited for.</source>
            <translation>つなぐ：まだ何も届いていません。何を待っているかは左にあります。</translation>
        </message>
        <message>
            <source>Plug: plug in a game controller or a MIDI device, or switch on a source on the left and let a program send to its port. Without any, press Learn and then a key of the keyboard.</source>
            <translation>つなぐ：ゲームコントローラーか MIDI 機器をつなぐか、左で送り手をオンにして、プログラムからそのポートへ送ってください。どれもなければ、学習を押してから、キーボードのキーを押します。</translation>
        </message>
        <message>
            <source>Map a source to whatever the character has: limbs, poses, shapes</source>
            <translation>送り手を、キャラクターが持つもの (手足、ポーズ、形) に対応づけます</translation>
        </message>
    </context>
    <context>
        <name>imomushi::MappingForm</name>
        <message>
            <source>A press</source>
            <translation>ボタン</translation>
        </message>
        <message>
            <source>Counts while it is held</source>
            <translation>押している間だけ働く</translation>
        </message>
        <message>
            <source>Switches on and off</source>
            <translation>押すたびに切り替わる</translation>
        </message>
        <message>
            <source>A button that is pressed counts while it is held, or switches: pressed once it is on, pressed again it is off.</source>
            <translation>ボタンは、押している間だけ働くか、押すたびにオンとオフが切り替わります。</translation>
        </message>
        <message>
            <source>Control</source>
            <translation>操作子</translation>
        </message>
        <message>
            <source>Control from</source>
            <translation>操作子の始まり</translation>
        </message>
        <message>
            <source>Where the range of the control begins.</source>
            <translation>操作子の範囲の始まり。</translation>
        </message>
        <message>
            <source>Control to</source>
            <translation>操作子の終わり</translation>
        </message>
        <message>
            <source>Where the range of the control ends.</source>
            <translation>操作子の範囲の終わり。</translation>
        </message>
        <message>
            <source>Becomes</source>
            <translation>動き</translation>
        </message>
        <message>
            <source>Becomes from</source>
            <translation>動きの始まり</translation>
        </message>
        <message>
            <source>What the beginning of the range becomes, from rest.</source>
            <translation>範囲の始まりがなる値。静止の姿から。</translation>
        </message>
        <message>
            <source>Becomes to</source>
            <translation>動きの終わり</translation>
        </message>
        <message>
            <source>What the end of the range becomes, from rest.</source>
            <translation>範囲の終わりがなる値。静止の姿から。</translation>
        </message>
        <message>
            <source>Turn the direction round</source>
            <translation>向きを逆にする</translation>
        </message>
        <message>
            <source>Curve</source>
            <translation>カーブ</translation>
        </message>
        <message>
            <source>1: straight. More: finer near the beginning, or near the middle of a control that has its rest there.</source>
            <translation>1：まっすぐ。大きいほど、始まりの近く、または中央で止まる操作子では中央の近くが細かくなります。</translation>
        </message>
        <message>
            <source>Dead zone</source>
            <translation>遊び</translation>
        </message>
        <message>
            <source>Dead zone: this part of the range, next to its beginning or middle, counts as that.</source>
            <translation>遊び：始まりまたは中央の隣の、範囲のこの割合は、そこと同じとみなします。</translation>
        </message>
        <message>
            <source>Smoothing</source>
            <translation>平滑化</translation>
        </message>
        <message>
            <source>How late what stands still is followed; 0: nothing is smoothed. What moves fast is followed sooner, by the number beside.</source>
            <translation>止まっているものに付いていく遅れ。0：平滑化しません。速い動きには、隣の数だけ早く付いていきます。</translation>
        </message>
        <message>
            <source>Reaction</source>
            <translation>反応</translation>
        </message>
        <message>
            <source>Reaction: the more, the sooner fast motion is followed (Hz per unit of the control and second).</source>
            <translation>反応：大きいほど、速い動きに早く付いていきます (操作子の 1 単位と 1 秒あたりの Hz)。</translation>
        </message>
        <message>
            <source>In silence</source>
            <translation>値が来ないとき</translation>
        </message>
        <message>
            <source>Holds</source>
            <translation>そのまま</translation>
        </message>
        <message>
            <source>Glides to rest</source>
            <translation>静止へ戻る</translation>
        </message>
        <message>
            <source>Next row</source>
            <translation>次の行</translation>
        </message>
        <message>
            <source>What happens when nothing is heard for longer than the time beside.</source>
            <translation>隣の時間より長く何も届かないときに起こること。</translation>
        </message>
        <message>
            <source>Silent after</source>
            <translation>無音までの時間</translation>
        </message>
        <message>
            <source>Silent after so many seconds; 0: never.</source>
            <translation>この秒数で無音とみなします。0：みなしません。</translation>
        </message>
        <message>
            <source>Spring</source>
            <translation>ばね</translation>
        </message>
        <message>
            <source>What is driven hangs on a spring that swings so fast; 0: no spring.</source>
            <translation>動かすものが、この速さで揺れるばねにつながります。0：ばねなし。</translation>
        </message>
        <message>
            <source>Damping of the spring</source>
            <translation>ばねの減衰</translation>
        </message>
        <message>
            <source>Damping: at 100 % it does not swing beyond.</source>
            <translation>減衰。100 % では行き過ぎません。</translation>
        </message>
        <message>
            <source>Other side</source>
            <translation>反対側</translation>
        </message>
        <message>
            <source>The same part of the other side does the same, mirrored, where no row of its own drives it.</source>
            <translation>反対側の同じものも、鏡写しに同じことをします。それを動かす行がほかにあれば、そちらが勝ちます。</translation>
        </message>
        <message>
            <source>What this row drives has no other side: names of sides end in .L and .R, or say left and right.</source>
            <translation>この行が動かすものには、反対側がありません。反対側のあるものの名前は、.L や .R で終わるか、left や right を含みます。</translation>
        </message>
    </context>
    <context>
        <name>imomushi::MappingModel</name>
        <message>
            <source>%1 drives it, too. This row wins now.</source>
            <translation>%1も動かします。今はこの行が勝っています。</translation>
        </message>
        <message>
            <source>%1 wins now.</source>
            <translation>今は%1が勝っています。</translation>
        </message>
        <message>
            <source>%1 drives it, too. The upper row wins.</source>
            <translation>%1も動かします。上の行が勝ちます。</translation>
        </message>
        <message>
            <source>%1 of “%2”, number %3</source>
            <comment>an address of a source</comment>
            <translation>「%2」の %1、%3 番目の数</translation>
        </message>
        <message>
            <source>The character has no “%1”. The row waits for it.</source>
            <translation>キャラクターに「%1」がありません。この行はそれを待ちます。</translation>
        </message>
        <message>
            <source>Muted: it drives nothing</source>
            <translation>ミュート中：何も動かしません</translation>
        </message>
        <message>
            <source>Mute: it drives nothing</source>
            <translation>ミュート：何も動かしません</translation>
        </message>
        <message>
            <source>Solo: rows that are not solo are muted</source>
            <translation>ソロ：ソロでない行はミュートされます</translation>
        </message>
        <message>
            <source>Control</source>
            <translation>操作子</translation>
        </message>
        <message>
            <source>Now</source>
            <translation>現在</translation>
        </message>
        <message>
            <source>Drives</source>
            <translation>動かすもの</translation>
        </message>
        <message>
            <source>Row %1, “%2”,</source>
            <comment>a mapping, its control</comment>
            <translation>行 %1「%2」</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ReceiverRows</name>
        <message>
            <source>Sent without bones: none of this character is a bone of a human, which is all that VMC knows. OSC tells of all of them.</source>
            <translation>ボーンなしで送っています。VMC が扱うのは人のボーンだけで、このキャラクターにはありません。OSC ならすべてのボーンを送れます。</translation>
        </message>
        <message>
            <source>On. Nothing was sent yet.</source>
            <translation>オンです。まだ何も送っていません。</translation>
        </message>
        <message>
            <source>%1 frames/s are sent.</source>
            <translation>毎秒 %1 フレームを送っています。</translation>
        </message>
        <message>
            <source>Nobody takes what is sent: does the other program listen?</source>
            <translation>送ったものが受け取られていません。相手のプログラムは待ち受けていますか。</translation>
        </message>
        <message>
            <source>On. What stands still is sent once a second.</source>
            <translation>オンです。止まっているものは、毎秒 1 回送ります。</translation>
        </message>
        <message>
            <source>Send what is performed</source>
            <translation>演技を送る</translation>
        </message>
        <message>
            <source>Add a receiver</source>
            <translation>送り先を追加</translation>
        </message>
        <message>
            <source>Another program is told where bones, handles and shapes are, 60 times a second or as often as the project says: an avatar by VMC, a show controller or another Imomushi by OSC.</source>
            <translation>ボーン、ハンドル、形の状態を、毎秒 60 回、またはプロジェクトの設定の回数だけ、ほかのプログラムに伝えます。アバターには VMC、ショーコントローラーや別の Imomushi には OSC を使います。</translation>
        </message>
        <message>
            <source>Send to %1</source>
            <comment>a receiver</comment>
            <translation>%1 に送る</translation>
        </message>
        <message>
            <source>Address of %1</source>
            <comment>a receiver</comment>
            <translation>%1 のアドレス</translation>
        </message>
        <message>
            <source>The address of the other machine; 127.0.0.1 is this one.</source>
            <translation>相手のコンピューターのアドレス。127.0.0.1 はこのコンピューターです。</translation>
        </message>
        <message>
            <source>Port of %1</source>
            <comment>a receiver</comment>
            <translation>%1 のポート</translation>
        </message>
        <message>
            <source>Remove this receiver</source>
            <translation>この送り先を削除</translation>
        </message>
        <message>
            <source>Remove %1</source>
            <comment>a receiver</comment>
            <translation>%1 を削除</translation>
        </message>
    </context>
    <context>
        <name>imomushi::SourceCalibrator</name>
        <message>
            <source>Nothing was heard. Let the source send, and measure again.</source>
            <translation>何も届きませんでした。送り手に送らせて、もう一度測ってください。</translation>
        </message>
        <message>
            <source>Rest</source>
            <comment>a pose</comment>
            <translation>静止の姿</translation>
        </message>
    </context>
    <context>
        <name>imomushi::SourceRows</name>
        <message>
            <source>Calibrated…</source>
            <translation>キャリブレーション済み…</translation>
        </message>
        <message>
            <source>Calibrate…</source>
            <translation>合わせる…</translation>
        </message>
        <message>
            <source>Calibrated, off by %1…</source>
            <translation>合わせてあります、ずれ %1…</translation>
        </message>
        <message>
            <source>What this source says in a pose of yours becomes that pose of the character: who stands turned or leans, or wears a sensor askew, is put right.</source>
            <translation>あなたがポーズをとったときにこの送り手が送るものが、キャラクターのそのポーズになります。向きの違い、傾き、斜めに付いたセンサーが直ります。</translation>
        </message>
        <message>
            <source>Listening. Any machine may send to port %1.</source>
            <translation>聞いています。どのコンピューターもポート %1 へ送れます。</translation>
        </message>
        <message>
            <source>Listening. Programs on this machine may send to 127.0.0.1, port %1.</source>
            <translation>聞いています。このコンピューターのプログラムは 127.0.0.1 のポート %1 へ送れます。</translation>
        </message>
        <message>
            <source>Silent: no sender is heard now.</source>
            <translation>無音：今はどの送り手も聞こえません。</translation>
        </message>
        <message>
            <source>Broken packets, left out: %1.</source>
            <translation>壊れていて除いたパケット：%1。</translation>
        </message>
        <message>
            <source>Packets that came too fast: %1.</source>
            <translation>速すぎて入らなかったパケット：%1。</translation>
        </message>
        <message>
            <source>Too many senders; packets of the others, left out: %1.</source>
            <translation>送り手が多すぎます。ほかの送り手の、除いたパケット：%1。</translation>
        </message>
        <message>
            <source>Add a source</source>
            <translation>送り手を追加</translation>
        </message>
        <message>
            <source>Listen to %1</source>
            <comment>a source</comment>
            <translation>%1 を聞く</translation>
        </message>
        <message>
            <source>Port</source>
            <translation>ポート</translation>
        </message>
        <message>
            <source>Port of %1</source>
            <comment>a source</comment>
            <translation>%1 のポート</translation>
        </message>
        <message>
            <source>Other machines may send, too</source>
            <translation>ほかのコンピューターも送れます</translation>
        </message>
        <message>
            <source>Remove this source</source>
            <translation>この送り手を削除</translation>
        </message>
        <message>
            <source>Remove %1</source>
            <comment>a source</comment>
            <translation>%1 を削除</translation>
        </message>
        <message>
            <source>Every machine that reaches this one may send. Click: programs on this machine alone.</source>
            <translation>このコンピューターに届くすべてのコンピューターが送れます。クリック：このコンピューターのプログラムだけにします。</translation>
        </message>
        <message>
            <source>Programs on this machine alone may send. Click: open the port to the network.</source>
            <translation>このコンピューターのプログラムだけが送れます。クリック：ポートをネットワークに開きます。</translation>
        </message>
        <message numerus="yes">
            <source>%1 packets/s from %n sender(s).</source>
            <translation>
                <numerusform>%n 件の送り手から毎秒 %1 パケット。</numerusform>
            </translation>
        </message>
        <message>
            <source>a game controller</source>
            <translation>ゲームコントローラー</translation>
        </message>
        <message>
            <source>Waits for %1 to be plugged in.</source>
            <comment>a device</comment>
            <translation>%1がつながれるのを待っています。</translation>
        </message>
        <message>
            <source>%1 is here. Nothing was moved yet.</source>
            <comment>a device</comment>
            <translation>%1があります。まだ何も動いていません。</translation>
        </message>
        <message>
            <source>%1: %2 packets/s.</source>
            <comment>a device</comment>
            <translation>%1：%2 パケット/秒。</translation>
        </message>
        <message>
            <source>None is plugged in.</source>
            <translation>つながれていません。</translation>
        </message>
        <message>
            <source>Ready. It is opened while you learn, and for rows that name it.</source>
            <translation>使えます。学習の間と、行がこれを挙げている間だけ開きます。</translation>
        </message>
        <message>
            <source>Device of %1</source>
            <comment>a source</comment>
            <translation>%1の機器</translation>
        </message>
        <message>
            <source>The first one</source>
            <translation>最初のもの</translation>
        </message>
        <message>
            <source>%1 (not here)</source>
            <comment>a device</comment>
            <translation>%1（ありません）</translation>
        </message>
        <message>
            <source>a MIDI device</source>
            <translation>MIDI 機器</translation>
        </message>
        <message>
            <source>a microphone</source>
            <translation>マイク</translation>
        </message>
        <message>
            <source>Keys of rows move the character while this window is in front. They do nothing else then.</source>
            <translation>このウィンドウが手前にある間、行のキーがキャラクターを動かします。そのキーは、ほかのことをしません。</translation>
        </message>
        <message>
            <source>Ready. Keys are heard while you learn, and where rows name them.</source>
            <translation>準備ができています。学習の間と、行が挙げているキーを聞きます。</translation>
        </message>
    </context>
<context>
        <name>imomushi::CyclesPanel</name>
        <message>
            <source>Suggest</source>
            <translation>提案</translation>
        </message>
        <message>
            <source>breathe</source>
            <comment>name of a cycle</comment>
            <translation>呼吸</translation>
        </message>
        <message>
            <source>sway</source>
            <comment>name of a cycle</comment>
            <translation>揺れる</translation>
        </message>
        <message>
            <source>crawl</source>
            <comment>name of a cycle</comment>
            <translation>這う</translation>
        </message>
        <message>
            <source>Make a cycle of the chosen poses, in their order</source>
            <translation>選んだポーズから、その順でサイクルを作ります</translation>
        </message>
        <message>
            <source>Choose two poses or more (Ctrl+click) to make a cycle of them</source>
            <translation>ポーズを 2 つ以上選ぶと（Ctrl＋クリック）、サイクルを作れます</translation>
        </message>
        <message>
            <source>%1 s</source>
            <comment>how long a round takes</comment>
            <translation>%1 秒</translation>
        </message>
        <message>
            <source>How long one round takes. Double click to change it.</source>
            <translation>一巡にかかる秒数。ダブルクリックで変えられます。</translation>
        </message>
        <message>
            <source>%1 %</source>
            <comment>how much of a cycle</comment>
            <translation>%1 %</translation>
        </message>
        <message>
            <source>%1×</source>
            <comment>how fast a cycle runs</comment>
            <translation>%1×</translation>
        </message>
        <message>
            <source>Cycles</source>
            <translation>サイクル</translation>
        </message>
        <message>
            <source>No cycles yet: movements that repeat through kept poses. Suggest some, or choose poses and make one of them.</source>
            <translation>サイクルはまだありません。サイクルは、保存したポーズを巡って繰り返す動きです。提案させるか、ポーズを選んで作ってください。</translation>
        </message>
        <message>
            <source>Suggest cycles and their poses from the skeleton: crawl, sway, breathe</source>
            <translation>骨格から、サイクルとそのポーズを提案します：這う、揺れる、息をする</translation>
        </message>
        <message>
            <source>Remove the cycle, and the poses that were suggested with it</source>
            <translation>サイクルと、一緒に提案されたポーズを削除</translation>
        </message>
        <message>
            <source>Amount</source>
            <translation>量</translation>
        </message>
        <message>
            <source>Speed</source>
            <translation>速さ</translation>
        </message>
        <message>
            <source>Amount of the cycle</source>
            <translation>サイクルの量</translation>
        </message>
        <message>
            <source>Speed of the cycle</source>
            <translation>サイクルの速さ</translation>
        </message>
        <message>
            <source>How much there is of the cycle: drag it, and the character moves. Double click: none</source>
            <translation>サイクルの量。ドラッグするとキャラクターが動きます。ダブルクリックで 0 に</translation>
        </message>
        <message>
            <source>How fast it runs, to the left backwards. Double click: as it was made</source>
            <translation>速さ。左へ引くと逆向き。ダブルクリックで作ったときの速さに</translation>
        </message>
    </context>
<context>
        <name>imomushi::PosesPanel</name>
        <message>
            <source>Double click or Alt+%1: pose the character so</source>
            <translation>ダブルクリックか Alt+%1：このポーズにする</translation>
        </message>
        <message>
            <source>Pose so</source>
            <translation>このポーズにする</translation>
        </message>
        <message>
            <source>Pose so, mirrored</source>
            <translation>左右反転してこのポーズにする</translation>
        </message>
        <message>
            <source>Half of the way</source>
            <translation>半分だけ近づける</translation>
        </message>
        <message>
            <source>Keep the present pose here</source>
            <translation>今のポーズをここに保存</translation>
        </message>
        <message>
            <source>Rename</source>
            <translation>名前を変更</translation>
        </message>
        <message>
            <source>Remove</source>
            <translation>削除</translation>
        </message>
        <message>
            <source>Poses</source>
            <translation>ポーズ</translation>
        </message>
        <message>
            <source>No poses yet. Pose the character, and keep the pose.</source>
            <translation>ポーズはまだありません。キャラクターにポーズを付けて、保存してください。</translation>
        </message>
        <message>
            <source>Part of the way</source>
            <translation>近づける割合</translation>
        </message>
        <message>
            <source>Part of the way to the chosen pose</source>
            <translation>選んだポーズに近づける割合</translation>
        </message>
        <message>
            <source>Drag: the character goes that far to the chosen pose</source>
            <translation>ドラッグ：選んだポーズにその割合だけ近づきます</translation>
        </message>
    </context>
    <context>
        <name>imomushi::SnapDialog</name>
        <message>
            <source>Steps to snap to</source>
            <translation>スナップの刻み</translation>
        </message>
        <message>
            <source>Grid</source>
            <translation>格子</translation>
        </message>
        <message>
            <source>Angle</source>
            <translation>角度</translation>
        </message>
        <message>
            <source>0 m: as fine as the view shows, in powers of ten.</source>
            <translation>0 m：見えている細かさに合わせます（10 の累乗）。</translation>
        </message>
        <message>
            <source>Close</source>
            <translation>閉じる</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ClipboardFlow</name>
        <message>
            <source>Copied “%1”</source>
            <translation>「%1」をコピーしました</translation>
        </message>
        <message numerus="yes">
            <source>Copied %n part(s)</source>
            <translation>
                <numerusform>%n 個をコピーしました</numerusform>
            </translation>
        </message>
        <message>
            <source>Nothing was copied yet.</source>
            <translation>まだ何もコピーしていません。</translation>
        </message>
        <message>
            <source>What was copied cannot be read: copy it once more.</source>
            <translation>コピーしたものを読めません。もう一度コピーしてください。</translation>
        </message>
        <message>
            <source>Pasting</source>
            <translation>貼り付けています</translation>
        </message>
        <message>
            <source>Pasted</source>
            <translation>貼り付けました</translation>
        </message>
        <message>
            <source>Pasted, but for “%1”: %2</source>
            <translation>貼り付けました。ただし「%1」：%2</translation>
        </message>
        <message>
            <source>Pasted, but for %1 parts. “%2”: %3</source>
            <translation>貼り付けました。ただし %1 個を除きます。「%2」：%3</translation>
        </message>
    </context>
    <context>
        <name>imomushi::PlaceDialog</name>
        <message>
            <source>Place a bone</source>
            <translation>ボーンを置く</translation>
        </message>
        <message>
            <source>Place a joint face</source>
            <translation>関節面を置く</translation>
        </message>
        <message>
            <source>Place a cut</source>
            <translation>切断面を置く</translation>
        </message>
        <message>
            <source>Place a handle</source>
            <translation>ハンドルを置く</translation>
        </message>
        <message>
            <source>%1: %2</source>
            <comment>what, and its axis</comment>
            <translation>%1：%2</translation>
        </message>
        <message>
            <source>Place</source>
            <translation>置く</translation>
        </message>
        <message>
            <source>Cancel</source>
            <translation>キャンセル</translation>
        </message>
        <message>
            <source>Body</source>
            <translation>ボディ</translation>
        </message>
        <message>
            <source>Element</source>
            <translation>要素</translation>
        </message>
        <message>
            <source>a point</source>
            <translation>点</translation>
        </message>
        <message>
            <source>%1 at rest</source>
            <comment>start or end</comment>
            <translation>%1（静止時）</translation>
        </message>
        <message>
            <source>Name</source>
            <translation>名前</translation>
        </message>
        <message>
            <source>Start</source>
            <translation>始点</translation>
        </message>
        <message>
            <source>End</source>
            <translation>終点</translation>
        </message>
        <message>
            <source>Origin</source>
            <translation>原点</translation>
        </message>
        <message>
            <source>Normal</source>
            <translation>法線</translation>
        </message>
        <message>
            <source>Tolerance</source>
            <translation>許容誤差</translation>
        </message>
        <message>
            <source>Place on the surface</source>
            <translation>表面上の位置</translation>
        </message>
        <message>
            <source>Radius</source>
            <translation>半径</translation>
        </message>
        <message>
            <source>Move a joint face</source>
            <translation>関節面を動かす</translation>
        </message>
        <message>
            <source>Move</source>
            <translation>動かす</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ReplayBar</name>
        <message>
            <source>How “%1” was built: %2 of %3</source>
            <translation>「%1」の作られ方：%2 / %3</translation>
        </message>
        <message>
            <source>Go on</source>
            <translation>続ける</translation>
        </message>
        <message>
            <source>Pause</source>
            <translation>一時停止</translation>
        </message>
        <message>
            <source>Stop</source>
            <translation>終了</translation>
        </message>
    </context>
    <context>
        <name>imomushi::ReplayFlow</name>
        <message>
            <source>Building “%1”</source>
            <translation>「%1」を組み立てています</translation>
        </message>
    </context>
</TS>
