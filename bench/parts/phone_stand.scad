// Phone stand: one profile of 70 mm width, with a hole for the cable.
$fn = 48;
difference() {
  rotate([90, 0, 0]) linear_extrude(70) offset(2) offset(-2)
    polygon([[0, 0], [85, 0], [85, 8], [70, 14], [30, 95], [18, 90], [52, 18], [14, 12], [8, 26], [0, 24]]);
  translate([-1, -35, 14]) rotate([0, 90, 0]) hull() for (z = [-3, 3]) translate([z, 0, 0]) cylinder(d = 12, h = 30);
}
