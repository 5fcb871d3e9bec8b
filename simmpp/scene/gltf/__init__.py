"""glTF 2.0 and GLB: the triangles of a file where its nodes put them, at rest.

A library was looked for first. pygltflib and gltflib keep JSON and bytes apart and decode nothing;
trimesh takes sparse, quantised, morphed and instanced data for plain, and names primitives at
random; Assimp takes quantised positions for zeros, and morphed and instanced data for plain.
"""
