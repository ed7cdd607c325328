// Coat hook of 80 mm: a bent round bar of 16 mm with a ball, on a plate with two screws.
$fn = 40;
difference() {
  union() {
    linear_extrude(8) hull() for (y = [-30, 40]) translate([0, y]) circle(d = 26);
    cylinder(d = 16, h = 36);
    translate([0, 20, 36]) rotate([0, 90, 0]) rotate([0, 0, 180]) rotate_extrude(angle = 90) translate([20, 0]) circle(d = 16);
    translate([0, 20, 56]) sphere(d = 22);
  }
  for (y = [-30, 40]) translate([0, y, -1]) { cylinder(d = 4.5, h = 12); translate([0, 0, 5]) cylinder(d1 = 4.5, d2 = 13.5, h = 4.5); }
}
