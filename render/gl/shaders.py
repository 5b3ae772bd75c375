"""The shading: Blinn-Phong under one light, with an optional texture and optional skinning.

An instance is placed by a translation relative to the eye (so that single precision suffices far
from the origin), a scale and a quaternion.  A skinned vertex blends four bones of its instance.
"""

BONES = 8

VERTEX = (
    """
#version 430
struct Instance { vec4 place; vec4 turn; };
layout(std430, binding = 0) readonly buffer Instances { Instance instances[]; };
#ifdef SKINNED
layout(std430, binding = 1) readonly buffer Palette { vec4 bones[]; };
in uvec4 in_bones;
in vec4 in_weights;
#endif
uniform mat4 projection;
uniform int first;
uniform int first_bone;
in vec3 in_position;
in vec3 in_normal;
in vec2 in_uv;
out vec3 eye_to_point;
out vec3 normal;
out vec2 uv;

vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }

void main() {
    Instance self = instances[first + gl_InstanceID];
    vec3 position = in_position;
    vec3 direction = in_normal;
#ifdef SKINNED
    int start = first_bone + gl_InstanceID * """
    + str(3 * BONES)
    + """;
    vec4 rows[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
    for (int i = 0; i < 4; i++) {
        int bone = start + 3 * int(in_bones[i]);
        for (int row = 0; row < 3; row++) rows[row] += in_weights[i] * bones[bone + row];
    }
    vec4 here = vec4(position, 1.0);
    position = vec3(dot(rows[0], here), dot(rows[1], here), dot(rows[2], here));
    direction = vec3(dot(rows[0].xyz, direction), dot(rows[1].xyz, direction),
                     dot(rows[2].xyz, direction));
#endif
    eye_to_point = self.place.xyz + self.place.w * turned(self.turn, position);
    normal = turned(self.turn, direction);
    uv = in_uv;
    gl_Position = projection * vec4(eye_to_point, 1.0);
}
"""
)

FRAGMENT = """
#version 430
uniform vec3 color;
#ifdef TEXTURED
uniform sampler2D image;
#endif
in vec3 eye_to_point;
in vec3 normal;
in vec2 uv;
out vec4 pixel;

const vec3 LIGHT = normalize(vec3(-0.45, -0.35, 0.82));

void main() {
    vec3 n = normalize(normal);
    vec3 to_eye = -normalize(eye_to_point);
    if (dot(n, to_eye) < 0.0) n = -n;  // open meshes are seen from both sides
    vec3 base = color;
#ifdef TEXTURED
    base *= texture(image, uv).rgb;
#endif
    float diffuse = 0.5 + 0.5 * dot(n, LIGHT);  // half Lambert: sides in the shade keep their shape
    float highlight = pow(max(dot(n, normalize(LIGHT + to_eye)), 0.0), 32.0);
    pixel = vec4(base * (0.3 + 0.7 * diffuse) + 0.2 * highlight, 1.0);
}
"""
