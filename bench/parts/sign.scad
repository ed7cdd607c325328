// Door sign of 90 x 40 x 10 mm: a frame and numbers stand on it, made of bars.
$fn = 32;
module bar(x, y, w, h) { translate([x, y]) square([w, h]); }
module four() { bar(0, 10, 4, 14); bar(0, 10, 14, 4); bar(10, 0, 4, 24); }
module two() { bar(0, 0, 14, 4); bar(0, 0, 4, 14); bar(0, 10, 14, 4); bar(10, 10, 4, 14); bar(0, 20, 14, 4); }
linear_extrude(10) offset(4) square([82, 32], center = true);
translate([0, 0, 9.5]) linear_extrude(4) {
  difference() { offset(4) square([82, 32], center = true); offset(2) square([82, 32], center = true); }
  translate([-20, -12]) four();
  translate([6, -12]) two();
}
