; HEADER_BLOCK_START ; aerate = begin
; aerate = end
; HEADER_BLOCK_END
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
