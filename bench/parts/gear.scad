// Spur gear: 24 teeth of module 3 (trapezoids), 18 mm wide, with a bore, a key and a hub.
$fn = 72;
teeth = 24; module_mm = 3; pitch = teeth * module_mm / 2;
module tooth() { polygon([[pitch - 4.5, -3.4], [pitch - 3.6, -3.1], [pitch + 3, -1.1], [pitch + 3, 1.1], [pitch - 3.6, 3.1], [pitch - 4.5, 3.4]]); }
difference() {
  union() {
    linear_extrude(18) { circle(pitch - 3.75); for (i = [0 : teeth - 1]) rotate(i * 360 / teeth) tooth(); }
    cylinder(d = 32, h = 28);
  }
  translate([0, 0, -1]) cylinder(d = 12, h = 40);
  translate([0, -2, -1]) cube([8.3, 4, 40]);
}
