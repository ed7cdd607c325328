;FLAVOR:Marlin
;Filament used: 0.5m
;Generated with Cura_SteamEngine 5.0
; thumbnail begin 1x1 4
; AAAA
; thumbnail end
;LAYER:0
G90
M83
G92 E0
G1 Z.2 F720
G1 X1 Y1
G1 X9 Y1 E.5
G2 X9 Y9 I0 J4 E1
M82
G91
G1 X-8 E.4 ; back
; filament used [mm] = 12.5
; layer_height = 0.2
; post_process = 
