// Shelf bracket of 60 mm with a gusset and screw holes.
$fn = 48;
module arm(size) { translate([-15, 0, 0]) cube([30, size, 10]); }
module hole(y) { translate([0, y, -1]) { cylinder(d = 5.2, h = 12); translate([0, 0, 7]) cylinder(d1 = 5.2, d2 = 13.2, h = 4.1); } }
difference() {
  union() {
    arm(60);
    rotate([90, 0, 0]) mirror([0, 0, 1]) arm(60);
    translate([-5, 0, 0]) rotate([90, 0, 90]) linear_extrude(10) polygon([[8, 8], [55, 8], [8, 55]]);
  }
  for (y = [25, 48]) for (x = [-10, 10]) translate([x, 0, 0]) hole(y);
  for (z = [25, 48]) for (x = [-10, 10]) translate([x, 0, 0]) rotate([90, 0, 0]) mirror([0, 0, 1]) hole(z);
}
