//! A motion for tests.

/// A humanoid of nine joints in BVH, walking in place, in centimetres.
pub const BVH: &str = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 90 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n\
JOINT Spine\n{\nOFFSET 0 15 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT Head\n{\nOFFSET 0 45 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 20 0\n}\n}\n}\n\
JOINT LeftUpLeg\n{\nOFFSET 10 -5 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT LeftLeg\n{\nOFFSET 0 -40 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT LeftFoot\n{\nOFFSET 0 -40 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 -5 15\n}\n}\n}\n}\n\
JOINT RightUpLeg\n{\nOFFSET -10 -5 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT RightLeg\n{\nOFFSET 0 -40 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT RightFoot\n{\nOFFSET 0 -40 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 -5 15\n}\n}\n}\n}\n}\n\
MOTION\nFrames: 2\nFrame Time: 0.5\n\
0 90 0 0 0 0  0 0 0  0 0 0  0 -20 0 0 0 0 0 0 0  0 20 0 0 10 0 0 0 0\n\
0 90 30 0 0 0  0 5 0  0 0 0  0 20 0 0 10 0 0 0 0  0 -20 0 0 0 0 0 0 0\n";
