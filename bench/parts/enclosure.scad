// Enclosure of 110 x 75 x 38 mm: walls of 5 mm, four screw bosses, a slot for a connector, air slots.
$fn = 32;
difference() {
  linear_extrude(38) offset(5) square([100, 65], center = true);
  difference() {
    translate([0, 0, 5]) linear_extrude(40) offset(2) square([96, 61], center = true);
    for (x = [-43, 43]) for (y = [-26, 26]) translate([x, y, 0]) cylinder(d = 14, h = 36);
  }
  for (x = [-43, 43]) for (y = [-26, 26]) translate([x, y, 12]) cylinder(d = 3.4, h = 40);
  translate([40, -9, 14]) cube([30, 18, 12]);
  for (i = [-4 : 4]) translate([i * 6 - 1.5, 25, 12]) cube([3, 30, 16]);
}
