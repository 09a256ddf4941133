// Of modes as in ~markers: green sticks, orange slides, blue hits, grey is open.
export const MODE_COLORS = ["#8a8a8a", "#1a9e3f", "#e87800", "#1a59e0"];
// Of bodies whose URDF has none, as in ~markers: calm ones, away from those of the modes.
export const BODY_COLORS = ["#8c99b3", "#bfa680", "#9980b3", "#80b3b3", "#bf8c99", "#b3b373", "#738c8c", "#a6a6a6"];
export const LINE_COLORS = ["#2b6cb0", "#c05621", "#2f855a", "#b83280", "#6b46c1", "#975a16", "#285e61", "#4a5568"];
