// Mounting plate of 100 x 70 x 8 mm with countersunk holes, slots and a raised rib.
$fn = 48;
difference() {
  union() {
    linear_extrude(8) offset(6) square([88, 58], center = true);
    translate([-40, -4, 0]) cube([80, 8, 18]);
  }
  for (x = [-42, 42]) for (y = [-27, 27]) translate([x, y, -1]) { cylinder(d = 4.3, h = 10); translate([0, 0, 6.5]) cylinder(d1 = 4.3, d2 = 10, h = 2.6); }
  for (y = [-18, 18]) translate([0, y, -1]) linear_extrude(10) hull() for (x = [-20, 20]) translate([x, 0]) circle(d = 6);
}
